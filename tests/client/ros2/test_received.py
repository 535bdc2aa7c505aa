"""Images in CDR: as rosbags serialises them, and cut, too long, of any bytes."""

import contextlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_client.errors import PacketError
from voltcam_client.packet import FrameMessage
from voltcam_client.ros2 import messages, received

FRAME = FrameMessage(image=np.arange(35, dtype=np.uint8).reshape(5, 7), t_us=1_234_567, seq=0, stamp_ns=1)
CDR = messages.image(FRAME)


@pytest.mark.parametrize("frame_id", ["", "a", "ab", "abc", "kamera"])
@pytest.mark.parametrize("little", [True, False])
def test_fields_are_those_that_rosbags_packed(frame_id: str, little: bool) -> None:
    typesys = pytest.importorskip("rosbags.typesys", reason="rosbags, the oracle, is in the extra [lab]")
    store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=3, nanosec=4_005_999)
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame_id)
    data = np.arange(140, dtype=np.uint8)
    fields: dict[str, Any] = {"height": 5, "width": 7, "encoding": "mono16", "is_bigendian": 1, "step": 28}
    image = types["sensor_msgs/msg/Image"](header=header, data=data, **fields)
    got = received.image(bytes(store.serialize_cdr(image, "sensor_msgs/msg/Image", little_endian=little)))
    assert got._replace(data=memoryview(b"")) == (3_004_005, "mono16", memoryview(b""), 7, 5, 28, True)
    assert bytes(got.data) == data.tobytes()
    compressed = types["sensor_msgs/msg/CompressedImage"](header=header, format="png", data=data[:99])
    raw = bytes(store.serialize_cdr(compressed, "sensor_msgs/msg/CompressedImage", little_endian=little))
    small = received.compressed_image(raw)
    assert (small.t_us, small.encoding, bytes(small.data)) == (3_004_005, "png", data[:99].tobytes())


def test_padding_at_the_end_is_none_of_the_image() -> None:
    for padding in range(4):
        assert bytes(received.image(CDR + bytes(padding)).data) == FRAME.image.tobytes()
    with pytest.raises(PacketError, match="no whole sensor_msgs/Image"):
        received.image(CDR + bytes(4))


def test_every_cut_is_said_in_one_line() -> None:
    for size in range(len(CDR)):
        with pytest.raises(PacketError, match="sensor_msgs/Image") as caught:
            received.image(CDR[:size])
        assert "\n" not in str(caught.value)


def test_what_is_no_stamp() -> None:
    for stamp in (b"\xff\xff\xff\xff\0\0\0\0", b"\0\0\0\0\xff\xff\xff\xff"):
        with pytest.raises(PacketError, match="does its publisher set"):
            received.image(CDR[:4] + stamp + CDR[12:])


def test_a_long_text_is_not_taken_whole() -> None:
    data = b"\0\1\0\0" + bytes(8) + b"\0\0\0\0" + (10**6).to_bytes(4, "little") + b"x" * 10**6
    assert len(received.compressed_image(data + bytes(4)).encoding) < 100


@given(st.binary(max_size=200), st.sampled_from([b"", b"\0\0\0\0", b"\0\1\0\0", b"\0\7\0\0"]))
def test_any_bytes_are_an_image_or_a_word(data: bytes, begin: bytes) -> None:
    for read in (received.image, received.compressed_image):
        with contextlib.suppress(PacketError):
            assert len(read(begin + data).data) <= len(data)
