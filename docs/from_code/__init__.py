"""What the reference says because the code says it.

A page holds a comment `<!-- from the code: NAME -->`, which no forge shows. When the site is built, the
Markdown that `CHAPTERS[NAME]` gives stands in its place.
"""

import re
from collections.abc import Callable

from . import commands, formats, parameters, rest, settings

CHAPTERS: dict[str, Callable[[], str]] = {
    "commands": commands.chapter,
    "formats": formats.chapter,
    "parameters": parameters.chapter,
    "presets": parameters.presets,
    "rest": rest.chapter,
    "settings": settings.chapter,
}
MARK = re.compile(r"<!-- from the code: (\w+) -->")


def filled(page: str) -> str:
    """The page's Markdown, with its chapters from the code. Raises KeyError for one that there is not."""
    return MARK.sub(lambda mark: CHAPTERS[mark[1]](), page)
