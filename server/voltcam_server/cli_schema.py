"""`voltcam schema`: what may be in a config file, for editors."""

import argparse
import json
import sys

from .settings import schema


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of `voltcam schema`."""
    parser.epilog = """\
example:
  voltcam schema > voltcam.schema.json
  and as the first line of the config file:  # yaml-language-server: $schema=voltcam.schema.json"""
    parser.set_defaults(run=_run)


def _run(_: argparse.Namespace) -> int:
    json.dump(schema(), sys.stdout, indent=2)
    print()
    return 0
