"""`.csv`: a header `t,x@346,y@260,on` and one event per line, t in whole microseconds. Events only.

That is faery's dialect, whose header has width and height. Headers `t,x,y,p` and `t_us,x,y,p` are read, too.
evlib takes no commas: it reads `.txt`.

Source: faery 0.7.1, what it writes.
"""

import re
from pathlib import Path

from voltcam_client.encodings import Events
from voltcam_client.formats.columns import LONGEST_HEADER, Layout, format_rows, read_events
from voltcam_client.formats.recording import Recording, smallest_size
from voltcam_client.formats.writer import AppendWriter

DESCRIPTION = "events as a table, t,x@WIDTH,y@HEIGHT,on with a header line, as faery has it; t in us"

_HEADER = r"(?:t|t_us), *x(?:@(\d{1,9}))?, *y(?:@(\d{1,9}))?, *(?:on|p)"
_LAYOUT = Layout(columns="t,x@WIDTH,y@HEIGHT,on", separator=",", seconds=False, header=_HEADER)


class CsvWriter(AppendWriter):
    """Appends lines `t,x,y,on`."""

    def _header(self) -> bytes:
        return f"t,x@{self.width},y@{self.height},on\n".encode("ascii")

    def _encode(self, events: Events) -> bytes:
        return format_rows("%d,%d,%d,%d\n", events["t"], events["x"], events["y"], events["p"])


def read_csv(path: Path) -> Recording:
    """Read a `.csv` recording; FormatError names the line that is not an event."""
    events = read_events(path, _LAYOUT)
    with path.open(encoding="utf-8", errors="replace") as file:
        header = re.fullmatch(_HEADER, file.readline(LONGEST_HEADER).strip())
    if header and header[1] and header[2]:
        return Recording(events, int(header[1]), int(header[2]))
    return Recording(events, *smallest_size(events))
