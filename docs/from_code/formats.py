"""What each suffix of a recording holds."""

from voltcam_client.formats import READABLE, SUFFIXES

from .markdown import name, plain, table


def chapter() -> str:
    """One line for each suffix."""
    rows = [
        (name(suffix), "yes", "yes" if suffix in SUFFIXES else "no", plain(description))
        for suffix, description in READABLE.items()
    ]
    return table(("suffix", "read", "written", "holds"), rows)
