"""Header and answer of a frame that a program sends: JSON that any language writes."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_client.errors import PacketError
from voltcam_client.pushed_frame import (
    ENCODINGS,
    Answer,
    FrameHeader,
    decode_answer,
    decode_header,
    encode_answer,
    encode_header,
)

HEADER = {"t_us": 5, "encoding": "mono8", "width": 4, "height": 3}

HEADERS = st.builds(
    FrameHeader,
    t_us=st.integers(0, 2**53 - 1),
    encoding=st.sampled_from(list(ENCODINGS)),
    width=st.integers(1, 4096),
    height=st.integers(1, 4096),
    step=st.none() | st.integers(1, 10**8),
    wait=st.booleans(),
    begin=st.booleans(),
)


@given(HEADERS)
def test_a_header_comes_as_it_goes(header: FrameHeader) -> None:
    assert decode_header(encode_header(header)) == header


def test_it_is_json_that_printf_could_write() -> None:
    plain = b'{"t_us":5,"encoding":"mono8","width":4,"height":3}'
    assert decode_header(plain) == FrameHeader(**HEADER)
    answer = Answer(t_us=5, result="dropped", reason="a newer one came")
    assert json.loads(encode_answer(answer)) == {
        "t_us": 5, "result": "dropped", "reason": "a newer one came", "shift_us": 0
    }  # fmt: skip
    assert decode_answer(encode_answer(answer)) == answer


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"t_us": -1}, "t_us is -1"),
        ({"t_us": 1.5}, "t_us is 1.5"),
        ({"t_us": True}, "t_us is True"),
        ({"t_us": 2**53}, "t_us is"),
        ({"encoding": "yuv"}, "encoding is 'yuv'"),
        ({"encoding": []}, "encoding is"),
        ({"width": 0}, "width is 0"),
        ({"width": 16000, "height": 16000}, "too many"),
        ({"wait": 1}, "wait is 1"),
        ({"begin": "yes"}, "begin is yes"),
        ({"exposure_us": 3}, "exposure_us"),
        ({"step": None}, "step is None"),
    ],
)
def test_what_cannot_be_is_said_in_a_line(change: dict[str, Any], words: str) -> None:
    with pytest.raises(PacketError, match=words.replace("(", r"\(")) as error:
        decode_header(json.dumps(HEADER | change).encode())
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 300


@pytest.mark.parametrize("missing", ["t_us", "encoding", "width", "height"])
def test_what_is_needed_is_named(missing: str) -> None:
    with pytest.raises(PacketError, match=missing):
        decode_header(json.dumps({k: v for k, v in HEADER.items() if k != missing}).encode())


@given(st.binary(max_size=5000) | st.just(b"[" * 4000) | st.just(b'{"t_us": ' + b"9" * 4000 + b"}"))
def test_any_bytes_are_a_header_or_one_line(data: bytes) -> None:
    for decode in (decode_header, decode_answer):
        line = ""
        try:
            decode(data)
        except PacketError as error:
            line = str(error)
        assert "\n" not in line
        assert len(line) < 300


def test_the_bytes_on_the_page_are_a_frame() -> None:
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "send-frames.md").read_text()
    header, image = (bytes.fromhex(line) for line in re.findall(r"^[0-9a-f]{16,}$", page, re.MULTILINE))
    assert json.loads(header) == {"t_us": 0, "encoding": "mono8", "width": 4, "height": 2}
    assert decode_header(header) == FrameHeader(t_us=0, encoding="mono8", width=4, height=2)
    assert image == b"\x0a" * 8
