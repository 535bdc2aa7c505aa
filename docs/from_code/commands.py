"""Every command, as its parser knows it."""

import argparse
from collections.abc import Iterator
from importlib import metadata

from voltcam_client.cli import OWN_COMMANDS, SUMMARIES

from .markdown import code, name, plain, sentence, table


def parsers() -> Iterator[tuple[str, str, argparse.ArgumentParser]]:
    """Name, the extra that it needs, and parser of each command; first those of the bare install."""
    for command, (summary, configure) in OWN_COMMANDS.items():
        yield command, "", _parser(command, summary, configure)
    entries = {entry.name: entry for entry in metadata.entry_points(group="voltcam.commands")}
    for command in sorted(entries, key=list(SUMMARIES).index):
        extra = "".join(entries[command].extras)
        yield command, extra, _parser(command, SUMMARIES[command], entries[command].load())


def _parser(command: str, summary: str, configure) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=f"voltcam {command}", description=summary, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    configure(parser)
    return parser


def chapter() -> str:
    """A section for each command."""
    every = list(parsers())
    rows = [
        (
            f"[`voltcam {command}`](#voltcam-{command})",
            plain(summary_of(command)),
            name(f"voltcam[{extra}]") if extra else "`voltcam`",
        )
        for command, extra, _ in every
    ]
    return (
        table(("command", "does", "comes with"), rows)
        + "\n"
        + "\n\n".join(_section(parser) for _, _, parser in every)
    )


def summary_of(command: str) -> str:
    return OWN_COMMANDS[command][0] if command in OWN_COMMANDS else SUMMARIES[command]


def _section(parser: argparse.ArgumentParser) -> str:
    parts = [f"## `{parser.prog}`", plain(sentence(parser.description or "")), code(_usage(parser))]
    rows = [(_called(action), plain(_help(action))) for action in parser._actions if action.dest != "help"]
    if rows:
        parts.append(table(("argument", "meaning"), rows))
    if parser.epilog:
        parts.append(code(parser.epilog))
    return "\n\n".join(parts)


def _usage(parser: argparse.ArgumentParser) -> str:
    words = parser.usage or parser.format_usage().removeprefix("usage: ")
    return words.replace(" [-h]", "").replace("\n       ", "\n")


def _called(action: argparse.Action) -> str:
    value = action.metavar or ("{" + ",".join(map(str, action.choices)) + "}" if action.choices else "")
    if not action.option_strings:
        return name(value or action.dest)
    return name(" ".join([*action.option_strings, *([str(value)] if action.nargs != 0 and value else [])]))


def _help(action: argparse.Action) -> str:
    text = (action.help or "").replace("%%", "%")
    return text.replace("%(default)s", str(action.default))
