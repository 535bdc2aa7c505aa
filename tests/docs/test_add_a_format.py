"""docs/how-to/add-a-format.md, followed to the letter on a copy of the repository."""

from pathlib import Path

from voltcam_client.formats import read
from voltcam_client.packet import EVENT

from .follow import follow


def test_the_page_adds_a_format(tmp_path: Path) -> None:
    page = follow("how-to/add-a-format.md", tmp_path)
    all_formats, own_test, use = page.commands
    assert " passed" in page.run(all_formats)
    assert "2 passed" in page.run(own_test)
    page.run(use)
    events = read(tmp_path / "scene.csv").events
    assert events.size > 0
    assert (tmp_path / "scene.bin").stat().st_size == 12 + EVENT.itemsize * events.size
    assert ".bin" in page.run("voltcam convert --help")
