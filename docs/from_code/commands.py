"""Every command, as its parser knows it."""

import argparse
from importlib import metadata

from voltcam_client.cli import OWN_COMMANDS, SUMMARIES

from .markdown import code, name, plain, sentence, table


def names() -> list[str]:
    """Of all commands; first those of the bare install."""
    added = {entry.name for entry in metadata.entry_points(group="voltcam.commands")}
    return [*OWN_COMMANDS, *(name for name in SUMMARIES if name in added)]


def parser_of(command: str) -> argparse.ArgumentParser:
    """The parser of one command, as `voltcam` makes it. Raises KeyError for one that there is not."""
    configure = OWN_COMMANDS[command][1] if command in OWN_COMMANDS else _entry(command).load()
    parser = argparse.ArgumentParser(
        prog=f"voltcam {command}",
        description=summary_of(command),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    configure(parser)
    return parser


def _entry(command: str) -> metadata.EntryPoint:
    return metadata.entry_points(group="voltcam.commands")[command]


def extra_of(command: str) -> str:
    """What must be installed for it beside the bare install."""
    extras = "" if command in OWN_COMMANDS else "".join(_entry(command).extras)
    return f"voltcam[{extras}]" if extras else "voltcam"


def chapter() -> str:
    """A section for each command."""
    rows = [
        (f"[`voltcam {command}`](#voltcam-{command})", plain(summary_of(command)), name(extra_of(command)))
        for command in names()
    ]
    sections = [_section(parser_of(command)) for command in names()]
    return "\n\n".join([table(("command", "does", "comes with"), rows), *sections])


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
