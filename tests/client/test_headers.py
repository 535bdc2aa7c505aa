"""What all messages share in their headers."""

import pytest

from voltcam_client.errors import PacketError
from voltcam_client.headers import pack_header, ros_header, stamp_ns_of, unpack_header


@pytest.mark.parametrize("stamp_ns", [0, 1, 999_999_999, 1_700_000_000_123_456_789])
def test_a_stamp_comes_back(stamp_ns: int) -> None:
    header = {"header": ros_header(stamp_ns, "left")}
    again = unpack_header(pack_header(header))
    assert again == header
    assert stamp_ns_of(again) == stamp_ns


@pytest.mark.parametrize("content", [b"", b"\xc1", b"\x93\x01\x02\x03", b"\xff" * 9])
def test_what_is_no_map_is_refused(content: bytes) -> None:
    with pytest.raises(PacketError, match="is it a Voltcam daemon"):
        unpack_header(content)
