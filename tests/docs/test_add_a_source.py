"""docs/how-to/add-a-source.md, followed to the letter on a copy of the repository."""

from pathlib import Path

import numpy as np

from voltcam_client.formats import read

from .follow import follow


def test_the_page_adds_a_source(tmp_path: Path) -> None:
    page = follow("how-to/add-a-source.md", tmp_path)
    own_test, use = page.commands
    assert "2 passed" in page.run(own_test)
    page.run(use)
    events = read(tmp_path / "rise.csv").events
    assert events.size > 0
    assert events["p"].all(), "light that only rises gives ON events only"
    assert np.ptp(events["t"]) > 200_000, "11 frames at 30 a second"
