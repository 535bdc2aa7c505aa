"""`.csv`: a header `t_us,x,y,p`, then one event per line, t in whole microseconds. Events only."""

from pathlib import Path

from voltcam_client.encodings import Events
from voltcam_client.formats.columns import Layout, format_rows, read_events
from voltcam_client.formats.recording import Recording, smallest_size
from voltcam_client.formats.writer import AppendWriter

DESCRIPTION = "events as a table, t_us,x,y,p with a header line"

_LAYOUT = Layout(columns="t_us,x,y,p", separator=",", has_header=True, seconds=False)


class CsvWriter(AppendWriter):
    """Appends lines `t_us,x,y,p`."""

    def _header(self) -> bytes:
        return f"{_LAYOUT.columns}\n".encode("ascii")

    def _encode(self, events: Events) -> bytes:
        return format_rows("%d,%d,%d,%d\n", events["t"], events["x"], events["y"], events["p"])


def read_csv(path: Path) -> Recording:
    """Read a `.csv` recording; FormatError names the line that is not an event."""
    events = read_events(path, _LAYOUT)
    return Recording(events, *smallest_size(events))
