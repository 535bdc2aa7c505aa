"""The fenced blocks of a page, and what is to be done with each.

A block is run unless an HTML comment above it, which no reader sees, says why not:

    <!-- not run: needs a camera -->

A comment `<!-- given: walk.npz -->` asks for a small file of that name, of those in `things.py`.
A comment `<!-- needs: torch -->` names libraries that [dev] has not: without them the block is skipped.
`python -m tests.docs.blocks` counts what is run and what is not.
"""

import re
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
COMMENT = re.compile(r"<!-- *(not run|given|needs): *(.*?) *-->", re.DOTALL)
RUN = ("python", "sh", "yaml", "json")
BEYOND = re.compile(
    r"\b(make|git|docker|pip|sudo|apt|calibrate|diagnose|evaluate|bench|doctor)\b"
    r"|/dev/|rtsp:|\.bag|_diagnosis\("
)
"""What a test has not, or not the time for. README.md is not to be cluttered, and needs no comment there."""


@dataclass(frozen=True)
class Block:
    """line: of the page, where its text begins, from 1. reason: why it is not run; None: it is."""

    language: str
    text: str
    line: int
    reason: str | None
    given: tuple[str, ...]
    needs: tuple[str, ...] = ()


def pages() -> list[Path]:
    """README.md and all pages, but for those that a test follows to the letter on a copy of all."""
    followed = {name for test in Path(__file__).parent.glob("test_*.py") for name in _followed(test)}
    every = sorted(DOCS.rglob("*.md"))
    return [
        ROOT / "README.md",
        *(page for page in every if page.relative_to(DOCS).as_posix() not in followed),
    ]


def _followed(test: Path) -> list[str]:
    return re.findall(r'follow\(\s*"([\w/.-]+\.md)"', test.read_text(encoding="utf-8"))


def blocks(page: Path) -> Iterator[Block]:
    """The blocks of the languages that can be run, in order."""
    reason, given, needs = None, (), ()
    for token in MarkdownIt().parse(page.read_text(encoding="utf-8")):
        if token.type == "html_block":
            for kind, words in COMMENT.findall(token.content):
                if kind == "given":
                    given = tuple(words.replace(",", " ").split())
                elif kind == "needs":
                    needs = tuple(words.replace(",", " ").split())
                else:
                    reason = " ".join(words.split())
        elif token.type == "fence":
            if token.info in RUN:
                assert token.map is not None
                if reason is None and page.name == "README.md" and BEYOND.search(token.content):
                    reason = "README.md: takes long, or needs what a test has not"
                yield Block(token.info, token.content, token.map[0] + 2, reason, given, needs)
            reason, given, needs = None, (), ()
        elif token.type in ("paragraph_open", "heading_open"):
            reason, given, needs = None, (), ()


def main() -> None:
    """Print how many blocks are run, and why others are not."""
    every = [block for page in pages() for block in blocks(page)]
    reasons = Counter(block.reason for block in every if block.reason is not None)
    sys.stdout.write(f"{len(every) - reasons.total()} of {len(every)} blocks are run\n")
    for reason, count in reasons.most_common():
        sys.stdout.write(f"{count:4} not run: {reason}\n")


if __name__ == "__main__":
    main()
