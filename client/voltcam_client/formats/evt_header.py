"""The lines that begin with % in Prophesee's files (EVT 2.0, EVT 3.0, DAT), written and read.

Times in such a file count from its beginning (see `start_us`). That is in a line of faery's,
`% t0 1700000000000000`, which others ignore.

Sources: docs.prophesee.ai/stable, data/file_formats/raw.html and dat.html; faery 0.7.1.
"""

from abc import abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from voltcam_client.encodings import Events
from voltcam_client.formats.recording import FormatError
from voltcam_client.formats.writer import AppendWriter, start_us


class HeaderWriter(AppendWriter):
    """Lines with %, then events that count from the file's beginning; a format gives lines and words."""

    longest_side: ClassVar[int]
    name: ClassVar[str]

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool = False) -> None:
        if max(width, height) > self.longest_side:
            side = self.longest_side
            raise FormatError(
                f"{path}: {self.name} has at most {side}x{side} pixels, not {width}x{height}: choose .npz"
            )
        super().__init__(path, width, height, overwrite=overwrite)
        self._t0_us = 0

    def _encode(self, events: Events) -> bytes:
        beginning = b""
        if self.event_count == 0:
            self._t0_us = start_us(int(events["t"][0]))
            beginning = self._last_lines()
        events = events.copy()
        events["t"] -= self._t0_us
        return beginning + self._words(events)

    @abstractmethod
    def _last_lines(self) -> bytes:
        """What comes between the header and the first event: it has t0, which the first event brings."""

    @abstractmethod
    def _words(self, events: Events) -> bytes:
        """The bytes of these events, whose times count from the beginning."""


@dataclass(frozen=True)
class Header:
    """keywords: lower case, with what is after them. t0_us: where times begin. start: of the words."""

    keywords: dict[str, str]
    t0_us: int
    size: tuple[int, int] | None
    start: int


def read_header(path: Path, data: bytes) -> Header:
    """Read the lines, up to '% end' or to the last that begins with '% '; one that a crash has cut short is
    left out. Raises FormatError."""
    keywords: dict[str, str] = {}
    start = 0
    while data.startswith(b"% ", start) and "end" not in keywords:
        end = data.find(b"\n", start) + 1
        if end == 0:
            start = len(data)
            break
        keyword, _, value = data[start + 2 : end].decode("latin-1").strip().partition(" ")
        keywords[keyword.lower()] = value.strip()
        start = end
    try:
        return Header(keywords, int(keywords.get("t0", 0)), _size(keywords), start)
    except (ValueError, KeyError) as error:
        raise FormatError(f"{path} has a header that makes no sense ({error}): correct it") from error


def _size(keywords: dict[str, str]) -> tuple[int, int] | None:
    """Width and height, from 'geometry WxH', 'format EVT3;height=H;width=W' or 'width W' and 'height H'."""
    if "geometry" in keywords:
        width, height = keywords["geometry"].split("x")
        return int(width), int(height)
    fields = dict(field.split("=", 1) for field in keywords.get("format", "").split(";") if "=" in field)
    fields = fields or {name: keywords[name] for name in ("width", "height") if name in keywords}
    return (int(fields["width"]), int(fields["height"])) if fields else None
