"""IMU samples and triggers as messages."""

import numpy as np
import pytest

from voltcam_client.errors import PacketError
from voltcam_client.headers import pack_header
from voltcam_client.samples import (
    IMU,
    TRIGGER,
    SamplesMessage,
    decode_imu,
    decode_triggers,
    encode_samples,
)

SAMPLES = np.array([(5, 25.5, (0, -1, 0), (1, 2, 3)), (9, 26, (0, -1, 0), (4, 5, 6))], IMU)
TRIGGERS = np.array([(5, 1), (9, 2), (9, 8)], TRIGGER)


@pytest.mark.parametrize(("samples", "decode"), [(SAMPLES, decode_imu), (TRIGGERS, decode_triggers)])
def test_what_is_encoded_is_decoded(samples: np.ndarray, decode) -> None:
    message = SamplesMessage(samples=samples, seq=7, stamp_ns=1_700_000_000_000_000_001, frame_id="left")
    again = decode(*encode_samples(message))
    np.testing.assert_array_equal(again.samples, samples)
    assert (again.seq, again.stamp_ns, again.frame_id) == (7, 1_700_000_000_000_000_001, "left")


def test_records_are_packed() -> None:
    assert (IMU.itemsize, TRIGGER.itemsize) == (36, 9)


@pytest.mark.parametrize("header", [{}, {"count": 2}, {"count": "two"}, {"count": 2, "seq": 1, "header": 5}])
def test_a_header_that_is_none_is_refused(header: dict[str, object]) -> None:
    with pytest.raises(PacketError):
        decode_imu(pack_header(header), SAMPLES.tobytes())


def test_a_buffer_that_is_cut_is_refused() -> None:
    header, buffer = encode_samples(SamplesMessage(samples=SAMPLES, seq=0, stamp_ns=0))
    for cut in (buffer[:-1], buffer[:36], buffer + buffer):
        with pytest.raises(PacketError, match="bytes are not 2 records"):
            decode_imu(header, cut)
