"""One base for what the package raises, and what a refusal tells a program."""

import pytest

from voltcam_client import Control
from voltcam_client.errors import ControlError, PacketError, VoltcamError
from voltcam_client.formats import FormatError, RecordingError


@pytest.mark.parametrize("kind", [PacketError, ControlError, FormatError])
def test_one_except_catches_all_that_is_wrong_with_data_and_requests(kind: type[Exception]) -> None:
    assert issubclass(kind, VoltcamError)
    assert issubclass(kind, ValueError)


def test_what_is_wrong_with_the_disk_is_an_os_error() -> None:
    assert issubclass(RecordingError, OSError)
    assert not issubclass(RecordingError, VoltcamError)


def test_a_refusal_has_its_status_and_no_answer_has_none() -> None:
    error = ControlError("no such camera: ask GET /cameras", 404)
    assert (str(error), error.status) == ("no such camera: ask GET /cameras", 404)
    with pytest.raises(ControlError) as caught:
        Control("http://127.0.0.1:1").status()
    assert caught.value.status is None
    assert "\n" not in str(caught.value)
