"""`voltcam config check`: a config file, looked at before it is used."""

import argparse
import sys
from pathlib import Path

from voltcam_video import SourceRequest

from .access import Tokens
from .access.reach import check_reach
from .plan import plans_of
from .settings import Settings, load


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of `voltcam config`."""
    parser.description = (
        "Check a config file as `voltcam serve --config FILE` would read it, and say what it means."
    )
    parser.epilog = """\
example:
  voltcam config check robot.yaml && systemctl restart voltcam"""
    parser.add_argument("action", choices=["check"], help="check: read it, and open nothing")
    parser.add_argument("file", metavar="FILE", type=Path, help="the config file (YAML)")
    parser.set_defaults(run=_run)


def _run(args: argparse.Namespace) -> int:
    settings = load({}, args.file)
    plans = plans_of(settings)
    tokens = Tokens.load(settings.access.tokens_file)
    check_reach(settings, tokens)
    lines = [f"{args.file} is well", f"  page     {settings.http}, {_asks(settings, tokens)}"]
    for plan in plans:
        active = ", ".join(effect.name for effect in plan.camera.parameters.effects() if effect.active)
        size = f"{plan.camera.width} x {plan.camera.height}"
        lines += [
            f"  camera   {plan.name}, {size}, seed {plan.settings.seed}: {active}",
            f"  source   {plan.settings.source.shown}{_there(plan.settings.source)}",
            f"  events   {plan.settings.zmq}, {_opens(settings)}",
            f"  DV       {plan.settings.dv}",
            f"  UDP      {plan.settings.udp}",
            f"  Foxglove {plan.settings.foxglove}",
            f"  ROS 2    {plan.settings.ros2}",
        ]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


def _asks(settings: Settings, tokens: Tokens) -> str:
    speaks = "https" if settings.access.tls_certificate else "http"
    return f"{speaks}, {'with tokens' if tokens else 'without a token'}"


def _opens(settings: Settings) -> str:
    keys = settings.access.curve_keys
    return f"for who has keys of {keys}" if keys else "without keys"


def _there(source: SourceRequest) -> str:
    """A word where a file or device is not there now: it may come."""
    path = source.device or source.photo_folder or source.path
    return "" if path is None or Path(path).exists() else " (not there now)"
