"""Prose is short: no sentence of a page has more than 40 words, few have more than 25.

    python -m tests.docs.test_sentences      the longest, and the share beyond 25 words, page by page

Left out are code, headings, pages that programs write, and decision records, which stay as they were
accepted. A table's cell is held to the same as a sentence.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token

DOCS = Path(__file__).parents[2] / "docs"
MOST_WORDS, GOOD_WORDS = 40, 25
MOST_BEYOND = 0.05
"""Share of the sentences beyond GOOD_WORDS, over all pages."""
WRITTEN = (
    "evaluation.md",
    "hidden-effects.md",
    "hidden-effects-40000.md",
    "hidden-effects-earlier.md",
    "calibration-accuracy.md",
    "reconstruction-study.md",
)  # by programs, in how-it-works
RECORD = re.compile(r"decisions/\d{4}-")
END = re.compile(r"(?<=[.!?:;])\s+(?=[^a-z\s])|(?<=[.!?])$")
ABBREVIATION = re.compile(r"\b(e\.g|i\.e|et al|Eq|Fig|vs|J|Prob)\.\s")


def pages() -> list[Path]:
    """Those that people write."""
    every = [page for page in sorted(DOCS.rglob("*.md")) if "_build" not in page.parts]
    return [page for page in every if page.name not in WRITTEN and not RECORD.search(page.as_posix())]


def sentences(page: Path) -> Iterator[str]:
    """All of a page; code and formulas count as one word each."""
    for token in MarkdownIt().enable("table").parse(_without_listings(page.read_text(encoding="utf-8"))):
        if token.type == "inline":
            text = ABBREVIATION.sub(lambda found: found[0].replace(". ", "._"), _plain(token))
            yield from (one.strip() for one in END.split(text) if one and one.strip())


def _without_listings(text: str) -> str:
    """Without headings, and formulas that stand alone."""
    text = re.sub(r"^#+ .*$", "", text, flags=re.MULTILINE)
    return re.sub(r"\$\$.*?\$\$", "", text, flags=re.DOTALL)


def _plain(token: Token) -> str:
    parts = []
    for child in token.children or []:
        if child.type == "code_inline":
            parts.append("Code")
        elif child.type in ("softbreak", "hardbreak"):
            parts.append(" ")
        elif child.type == "text":
            parts.append(child.content)
    return re.sub(r"\$[^$]*\$", "Formula", "".join(parts))


def words(sentence: str) -> int:
    """What has a letter or a digit."""
    return sum(bool(re.search(r"\w", word)) for word in sentence.split())


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.relative_to(DOCS).as_posix())
def test_no_sentence_is_too_long(page: Path) -> None:
    long = [f"{words(one)} words: {one}" for one in sentences(page) if words(one) > MOST_WORDS]
    assert not long, "\n".join(long)


def test_few_sentences_are_long() -> None:
    lengths = [words(one) for page in pages() for one in sentences(page)]
    beyond = sum(length > GOOD_WORDS for length in lengths)
    assert beyond <= MOST_BEYOND * len(lengths), f"{beyond} of {len(lengths)} beyond {GOOD_WORDS} words"


def test_a_sentence_is_counted_without_its_code() -> None:
    [token] = [one for one in MarkdownIt().parse("It runs `a b c` at $x + y$ here.") if one.type == "inline"]
    assert words(_plain(token)) == 6


def main() -> None:
    """Print the share beyond GOOD_WORDS, and each sentence that is."""
    total = beyond = 0
    for page in pages():
        every = list(sentences(page))
        long = sorted((one for one in every if words(one) > GOOD_WORDS), key=words, reverse=True)
        total, beyond = total + len(every), beyond + len(long)
        if long:
            sys.stdout.write(f"{page.relative_to(DOCS)}: {len(long)} of {len(every)}\n")
        for one in long:
            sys.stdout.write(f"  {words(one):3} {one}\n")
    sys.stdout.write(
        f"{beyond} of {total} sentences ({beyond / total:.1%}) have more than {GOOD_WORDS} words\n"
    )


if __name__ == "__main__":
    main()
