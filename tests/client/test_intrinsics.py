"""Files of camera_calibration, and files that are none."""

from pathlib import Path

import pytest

from voltcam_client import VoltcamError
from voltcam_client.intrinsics import read_intrinsics

FILE = """\
image_width: 346
image_height: 260
camera_name: davis
camera_matrix:
  rows: 3
  cols: 3
  data: [250.5, 0, 173, 0, 251, 130, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.3, 0.1, 0, 1e-3, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [250.5, 0, 173, 0, 0, 251, 130, 0, 0, 0, 1, 0]
"""


def test_a_file_as_the_calibrator_writes_it(tmp_path: Path) -> None:
    path = tmp_path / "davis.yaml"
    path.write_text(FILE)
    read = read_intrinsics(path)
    assert (read.size, read.model) == ((346, 260), "plumb_bob")
    assert read.distortion == (-0.3, 0.1, 0, 0.001, 0)
    assert read.k == (250.5, 0, 173, 0, 251, 130, 0, 0, 1)
    assert read.r == (1, 0, 0, 0, 1, 0, 0, 0, 1)
    assert read.p == (250.5, 0, 173, 0, 0, 251, 130, 0, 0, 0, 1, 0)


@pytest.mark.parametrize(
    "content",
    [
        "",
        "a: [1, 2",
        "[]",
        "5",
        FILE.replace("346", "-1"),
        FILE.replace("346", "yes"),
        FILE.replace("[250.5, 0, 173, 0, 251, 130, 0, 0, 1]", "[1, 2]"),
        FILE.replace("251", ".nan"),
        FILE.replace("1e-3", "a"),
        FILE.replace("distortion_model: plumb_bob\n", ""),
        "a: &a [1]\nb: *a\n",
        "[" * 100_000,
        "\0\xff",
    ],
)
def test_what_is_none_is_said_in_a_line(tmp_path: Path, content: str) -> None:
    path = tmp_path / "davis.yaml"
    path.write_text(content, encoding="latin-1")
    with pytest.raises(VoltcamError, match="is no camera_info file") as caught:
        read_intrinsics(path)
    assert "\n" not in str(caught.value)
