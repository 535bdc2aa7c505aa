"""Pieces of Markdown."""

import inspect
import textwrap
from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table; its cells are Markdown, lines in them are joined."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(_cell, line)) + " |" for line in lines) + "\n"


def _cell(content: object) -> str:
    return " ".join(str(content).split()).replace("|", "\\|")


def plain(text: str) -> str:
    """Words of the code as Markdown that looks like them."""
    return text.replace("\\", "\\\\").replace("<", "\\<").replace("*", "\\*").replace("$", "\\$")


def prose(docstring: str | None) -> str:
    """A docstring as Markdown: what is indented in it is shown as it stands, such as a formula."""
    blocks = inspect.cleandoc(docstring or "").split("\n\n")
    return "\n\n".join(code(block) if block.startswith("    ") else plain(block) for block in blocks)


def code(text: str, language: str = "text") -> str:
    """A block of code."""
    return f"```{language}\n{textwrap.dedent(text).strip()}\n```"


def name(text: object) -> str:
    """A name or value as the code writes it."""
    return f"`{text}`"


def sentence(text: str) -> str:
    """With a full stop, and a capital unless it begins with a name."""
    text = text.strip()
    begin = text.partition(" ")[0]
    capital = text[:1].upper() if begin.rstrip(",").isalpha() else text[:1]
    return capital + text[1:] + ("" if text.endswith((".", ":", "?")) or not text else ".")
