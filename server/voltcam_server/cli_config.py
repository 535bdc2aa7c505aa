"""`voltcam config check`: a config file, looked at before it is used."""

import argparse
import sys
from pathlib import Path

from voltcam_video import SourceRequest

from .access import Tokens
from .access.reach import check_reach
from .api import check_encoding
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
    camera = settings.load_camera()
    check_encoding(settings.encoding, camera.width, camera.height)
    tokens = Tokens.load(settings.access.tokens_file)
    check_reach(settings, tokens)
    active = ", ".join(effect.name for effect in camera.parameters.effects() if effect.active)
    lines = [
        f"{args.file} is well",
        f"  camera   {camera.name}, {camera.width} x {camera.height}, seed {settings.seed}: {active}",
        f"  source   {settings.source.shown}{_there(settings.source)}",
        f"  page     {settings.http}, {_asks(settings, tokens)}",
        f"  events   {settings.zmq}, {_opens(settings)}",
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
    path = source.device or source.uri
    if source.uri == "scene" or "://" in path or Path(path).exists():
        return ""
    return " (not there now)"
