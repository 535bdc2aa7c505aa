"""Messages and maps over a connection; what is none ends in one line, in time and in little memory."""

import contextlib
import socket
import threading
import time
import tracemalloc
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_client.ros1 import RosError
from voltcam_client.ros1.tcpros import decode_fields, encode_fields, receive_fields, receive_message

Pair = tuple[socket.socket, socket.socket]


@pytest.fixture
def pair() -> Iterator[Pair]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield ours, theirs


def test_the_map_of_the_documentation() -> None:
    """wiki.ros.org/ROS/Connection Header: a length, and KEY=VALUE after its length."""
    packed = encode_fields(
        {"message_definition": "string data\n\n", "callerid": "/rostopic_4767_1316912741557"}
    )
    assert packed[:8] == bytes.fromhex("4c000000 20000000".replace("4c", f"{len(packed) - 4:02x}"))
    assert packed[8:40] == b"message_definition=string data\n\n"
    assert packed[40:45] == b"\x25\0\0\0c"


@settings(deadline=None)
@given(st.dictionaries(st.text(st.characters(codec="ascii", exclude_characters="="), min_size=1), st.text()))
def test_maps_come_back(fields: dict[str, str]) -> None:
    assert decode_fields(encode_fields(fields)[4:]) == fields


@settings(deadline=None)
@given(st.binary(max_size=200))
def test_what_is_no_map_is_said(body: bytes) -> None:
    with contextlib.suppress(RosError):
        assert sum(len(key) for key in decode_fields(body)) <= len(body)


def test_messages_come_one_after_the_other(pair: Pair) -> None:
    ours, theirs = pair
    theirs.sendall(b"\3\0\0\0abc\0\0\0\0\1\0\0\0d")
    assert [receive_message(ours, 10) for _ in range(3)] == [b"abc", b"", b"d"]
    theirs.close()
    with pytest.raises(EOFError):
        receive_message(ours, 10)


@pytest.mark.parametrize(
    ("sent", "words"),
    [
        (b"\xff\xff\xff\xff", "4294967295 bytes, of which 100000000 are taken"),
        (b"\x00\xe1\xf5\x05abc", "100000000 bytes was cut short"),
    ],
)
def test_a_length_is_believed_as_bytes_come(pair: Pair, sent: bytes, words: str) -> None:
    ours, theirs = pair
    theirs.sendall(sent)
    theirs.shutdown(socket.SHUT_WR)
    tracemalloc.start()
    with pytest.raises(RosError, match=words):
        receive_message(ours, 100_000_000)
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak_bytes < 4_000_000


def test_who_speaks_a_byte_at_a_time_is_not_waited_for(pair: Pair) -> None:
    ours, theirs = pair
    over = threading.Event()

    def drip() -> None:
        theirs.sendall(b"\xff\0\0\0")
        while not over.wait(0.02):
            theirs.sendall(b"a")

    thread = threading.Thread(target=drip)
    thread.start()
    began_s = time.monotonic()
    try:
        with pytest.raises(TimeoutError):
            receive_fields(ours, 0.3)
    finally:
        over.set()
        thread.join()
    assert time.monotonic() - began_s < 5


def test_random_bytes(pair: Pair) -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        ours, theirs = socket.socketpair()
        with ours, theirs:
            theirs.sendall(rng.bytes(int(rng.integers(0, 300))))
            theirs.shutdown(socket.SHUT_WR)
            with contextlib.suppress(RosError, EOFError):
                for _ in range(100):  # none is longer
                    receive_fields(ours, 1)
                raise AssertionError("it has no end")
