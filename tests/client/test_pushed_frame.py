"""The message of a frame and its answer, as other programs write and read them."""

import json

import pytest

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import Answer, FrameHeader, decode_answer, decode_header, encode_answer

# {"t_us": 1000, "encoding": "mono8", "width": 2, "height": 1}
HEX = (
    "7b22745f7573223a20313030302c2022656e636f64696e67223a20226d6f6e6f38222c"
    "20227769647468223a20322c2022686569676874223a20317d"
)


def test_bytes_of_another_program_are_read() -> None:
    header = decode_header(bytes.fromhex(HEX))
    assert header == FrameHeader(t_us=1000, encoding="mono8", width=2, height=1)


def test_an_answer_is_plain_json() -> None:
    answer = Answer(t_us=1000, result="skipped", reason="too long", shift_us=5)
    packed = encode_answer(answer)
    assert json.loads(packed) == {"t_us": 1000, "result": "skipped", "reason": "too long", "shift_us": 5}
    assert decode_answer(packed) == answer


@pytest.mark.parametrize("wrong", ['"t_us": -1', '"t_us": 9007199254740992', '"t_us": 1, "wiat": true'])
def test_a_wrong_header_is_refused_in_one_line(wrong: str) -> None:
    with pytest.raises(PacketError) as caught:
        decode_header(f'{{"encoding": "png", {wrong}}}'.encode())
    assert "\n" not in str(caught.value)
