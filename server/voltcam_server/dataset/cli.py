"""`voltcam dataset`: from a folder of videos to a data set."""

import argparse
from functools import partial
from pathlib import Path
from typing import Any

import joblib

from voltcam_client.cli_arguments import seconds
from voltcam_simulator.parameters import merged

from ..problems import UsageError
from ..settings import parse_change
from .spec import Spec, load_spec, spec_of

BY_CTRL_C = 130


def configure(parser: argparse.ArgumentParser) -> None:
    """The command line of `voltcam dataset`."""
    parser.description = "Make a data set of events from videos and images, verify it, and look at it."
    parser.epilog = """\
examples:
  voltcam dataset make spec.yaml set/
  voltcam dataset make 'videos/*.mp4' set/ --variants 3 --set 'comparator.theta_on={uniform: [0.8, 1.2]}'
  voltcam dataset make spec.yaml set/ --engine dask://head:8786
  voltcam dataset check set/
  voltcam dataset show set/

Ctrl-C ends `make` in good order; the same command goes on where it was."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    _make(actions)
    _check(actions)
    _show(actions)


def _make(actions: Any) -> None:
    parser = _action(actions, "make", "make a set, or go on with one")
    parser.add_argument("what", metavar="SPEC", help="a spec (.yaml), or a pattern of videos or folders")
    parser.add_argument("out", metavar="OUT", type=Path, help="folder of the set")
    parser.add_argument("--workers", metavar="N", type=_count, help="processes (default: one for each core)")
    parser.add_argument(
        "--engine", metavar="WHERE", default="local", help="local, or dask://HOST:PORT of a scheduler"
    )
    spec = parser.add_argument_group("instead of a spec, or over it")
    spec.add_argument("--camera", metavar="NAME", action="append", help="one, or several to draw from")
    spec.add_argument("--variants", metavar="N", type=_count, help="of each input (default: 1)")
    spec.add_argument("--seed", metavar="N", type=int, help="the same gives the same set (default: 0)")
    spec.add_argument("--upsample", metavar="HOW", help="as in `voltcam convert` (default: cubic)")
    spec.add_argument("--fps", metavar="N", type=float, help="of folders of images without times")
    spec.add_argument("--seconds", metavar="N", type=seconds, help="of each input")
    spec.add_argument("--format", choices=(".h5", ".aedat4", ".npz"), help="of the items (default: .h5)")
    spec.add_argument("--no-frames", action="store_false", dest="frames", default=None, help="events only")
    spec.add_argument("--shard", metavar="N", type=_count, help="items to a folder (default: all in one)")
    spec.add_argument(
        "--set",
        metavar="EFFECT.NAME=HOW",
        action="append",
        default=[],
        help="a value, {uniform: [A, B]}, {log_uniform: [A, B]}, {choice: [A, B]} or interval",
    )
    parser.set_defaults(run=_run_make)


def _check(actions: Any) -> None:
    parser = _action(actions, "check", "hold a set against its manifest")
    parser.add_argument("set", metavar="SET", type=Path, help="folder of the set")
    parser.set_defaults(run=_run_check)


def _show(actions: Any) -> None:
    parser = _action(actions, "show", "make a page of a set: pictures, rates, parameters, outliers")
    parser.add_argument("set", metavar="SET", type=Path, help="folder of the set")
    parser.add_argument("--out", metavar="FILE", type=Path, help="default: index.html in the set")
    parser.set_defaults(run=_run_show)


def _run_check(args: argparse.Namespace) -> int:
    from .check import check_set

    found = check_set(args.set)
    for fault in found.faults:
        print(fault)
    print(found.words)
    return 1 if found.faults else 0


def _run_show(args: argparse.Namespace) -> int:
    from .show import show_set

    print(f"{show_set(args.set, args.out or args.set / 'index.html')} written")
    return 0


def _run_make(args: argparse.Namespace) -> int:
    from .engines import open_engine
    from .make import STOPPED, make_set

    workers = args.workers or int(joblib.cpu_count())
    done = make_set(_spec(args), args.out, partial(open_engine, args.engine, workers))
    print(done.words)
    if done.left:
        return BY_CTRL_C if done.ended == STOPPED else 1
    return 1 if done.failed else 0


def _spec(args: argparse.Namespace) -> Spec:
    given: dict[str, Any] = {
        name: value
        for name in ("camera", "variants", "seed", "upsample", "seconds", "format", "frames", "shard")
        if (value := getattr(args, name)) is not None
    }
    for text in args.set:
        given = merged(given, {"parameters": parse_change(text)})
    if args.what.endswith((".yaml", ".yml")):
        if args.fps is not None:
            raise UsageError("--fps: say it in the spec, of the input it is about")
        return load_spec(Path(args.what), given)
    return spec_of({"inputs": {"files": args.what, "fps": args.fps}} | given, "command line")


def _action(actions: Any, name: str, summary: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = actions.add_parser(name, help=summary, description=summary)
    return parser


def _count(text: str) -> int:
    number = int(text)
    if number < 1:
        raise ValueError
    return number
