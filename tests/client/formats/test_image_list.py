"""Times and names of images, for recordings and for sources."""

from pathlib import Path

import pytest

from voltcam_client.formats import FormatError
from voltcam_client.formats.image_list import ListedImage, read_image_list


def listed(folder: Path, text: str) -> list[ListedImage]:
    (folder / "images.txt").write_text(text)
    return read_image_list(folder / "images.txt")


def test_lines_are_counted_with_those_that_are_none(tmp_path: Path) -> None:
    found = listed(tmp_path, "# seconds file\n\n0.5 b.png\n  # more\n1e0\tmy images/c d.png\n")
    assert found == [
        ListedImage(3, 500_000, tmp_path / "b.png"),
        ListedImage(5, 1_000_000, tmp_path / "my images" / "c d.png"),
    ]


def test_epoch_seconds_are_rounded_as_decimals(tmp_path: Path) -> None:
    """As floats these are a quarter of a microsecond apart at best."""
    (found,) = listed(tmp_path, "4102444800.000000500 a.png\n")
    assert found.t_us == 4_102_444_800_000_000  # half goes to even
    (found,) = listed(tmp_path, "4102444800.000000501 a.png\n")
    assert found.t_us == 4_102_444_800_000_001


@pytest.mark.parametrize("line", ["a.png", "nan a.png", "inf a.png", "0.5", "0.5 ", "0,5 a.png"])
def test_the_line_that_is_none_is_named(line: str, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"images\.txt, line 2: not 'seconds filename'"):
        listed(tmp_path, f"0 a.png\n{line}\n")


@pytest.mark.parametrize("name", ["../a.png", "/etc/passwd", "b/../../a.png"])
def test_no_line_leads_out_of_the_folder(name: str, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="line 1: the image is outside"):
        listed(tmp_path, f"0 {name}\n")
