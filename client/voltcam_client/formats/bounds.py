"""Files that are not what they say: sizes are checked before memory is taken for them."""

import contextlib
from collections.abc import Iterator
from pathlib import Path

from voltcam_client.errors import VoltcamError
from voltcam_client.formats.recording import FormatError

MOST_SWELL = 250  # how much larger than its file a recording may be; dark frames compress best
SMALL_BYTES = 1 << 26  # so much may be in the smallest file


def fits(path: Path, size_bytes: int) -> None:
    """Whether a file may hold so much. Raises FormatError."""
    if size_bytes > SMALL_BYTES + MOST_SWELL * path.stat().st_size:
        raise FormatError(
            f"{path} says that it holds {size_bytes:.2g} bytes, which is more than it can: copy it again"
        )


@contextlib.contextmanager
def whole(path: Path) -> Iterator[None]:
    """What a reader stumbles over in a file as a FormatError of one line, without anything of its content."""
    try:
        yield
    except (VoltcamError, OSError):
        raise
    except Exception as error:  # of numpy, zipfile, json, struct: each has its own
        raise FormatError(
            f"{path} is damaged or no such file ({type(error).__name__}): copy it again"
        ) from error
    except BaseException as error:  # how a library written in Rust says that it has given up
        if type(error).__name__ != "PanicException":
            raise
        raise FormatError(f"{path} is damaged: copy or record it again") from None
