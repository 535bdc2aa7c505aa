"""`voltcam status`: what a running daemon says of itself."""

import argparse
import json
from collections.abc import Iterator
from typing import Any

from voltcam_client import control


def configure(parser: argparse.ArgumentParser) -> None:
    parser.description = "Print what a running daemon says of itself: rates, drops, source, recording."
    parser.epilog = """\
examples:
  voltcam status                                   the daemon on this machine
  voltcam status http://robot.local:8560 --json | jq .source"""
    default = control.DEFAULT_URL
    parser.add_argument(
        "url", metavar="URL", nargs="?", default=default, help=f"where the daemon is (default: {default})"
    )
    parser.add_argument("--json", action="store_true", help="print the whole answer as JSON")
    parser.set_defaults(run=_status)


def _status(args: argparse.Namespace) -> int:
    status = control.Control(args.url).status()
    if args.json:
        print(json.dumps(status, indent=2))
    else:
        lines = dict(_flat(status))
        width = max(map(len, lines), default=0)
        for name, value in lines.items():
            print(f"{name:<{width}}  {'-' if value is None or value == '' else value}")
    return 0


def _flat(tree: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """{"a": {"b": 1}} to ("a.b", 1)."""
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value
