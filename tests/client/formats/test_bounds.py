"""Sizes that a file states are checked before memory is taken for them."""

import os
from pathlib import Path

import pytest

from voltcam_client.formats import FormatError
from voltcam_client.formats.bounds import MOST_SWELL, SMALL_BYTES, fits, whole


def test_a_file_may_hold_so_much_and_no_byte_more(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(bytes(1000))
    most = SMALL_BYTES + 1000 * MOST_SWELL
    fits(path, most)
    with pytest.raises(FormatError, match="more than it can"):
        fits(path, most + 1)


@pytest.mark.parametrize("error", [KeyError("x"), ValueError("a\nb"), IndexError("secret of the file")])
def test_a_reader_s_own_errors_become_one_line_without_the_file_s_content(error: Exception) -> None:
    with pytest.raises(FormatError) as caught, whole(Path("walk.npz")):
        raise error
    assert "walk.npz" in str(caught.value)
    assert type(error).__name__ in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "secret" not in str(caught.value)


@pytest.mark.parametrize(
    "error", [OSError(5, os.strerror(5)), FormatError("walk.npz: mine"), KeyboardInterrupt()]
)
def test_what_says_more_goes_on_as_it_is(error: BaseException) -> None:
    with pytest.raises(type(error)) as caught, whole(Path("walk.npz")):
        raise error
    assert caught.value is error
