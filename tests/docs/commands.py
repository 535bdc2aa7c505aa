"""The commands of Voltcam in a page's text, and their parsers."""

import argparse
import re
import shlex
import sys
from collections.abc import Iterator
from itertools import dropwhile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "docs"))
from from_code.commands import names, parser_of

ENDS = {"|", "||", "&&", ";", "&", ">", ">>", "2>"}


def parse(arguments: list[str]) -> argparse.Namespace:
    """What `voltcam` is told. Ends the program, as argparse does, where it cannot be told so."""
    if arguments[0] not in names():
        raise SystemExit(f"there is no command {arguments[0]!r}")
    return parser_of(arguments[0]).parse_args(arguments[1:])


def commands(text: str) -> Iterator[list[str]]:
    """The arguments of each `voltcam COMMAND ...` in lines of shell, behind variables and a folder or not."""
    for line in re.sub(r"\\\n\s*", " ", text).splitlines():
        simple: list[str] = []
        for word in [*shlex.split(line, comments=True), ";"]:
            if word not in ENDS:
                simple.append(word)
                continue
            program, *arguments = [*dropwhile(lambda one: "=" in one, simple), ""]
            if Path(program).name == "voltcam" and arguments[0] and not arguments[0].startswith("-"):
                yield arguments[:-1]
            simple = []
