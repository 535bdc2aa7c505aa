"""The event buffer of a packet in its four encodings, as ROS ``event_camera_msgs`` uses them.

Everything is little-endian. `us` is an event's time after the packet's ``time_base``.

============ ===== ======= ======================================================================
encoding     word  bits    field
============ ===== ======= ======================================================================
libcaer      u32   0       valid: written as 1, not read
                   1       polarity, 1 = ON
                   2..16   y
                   17..31  x
             i32   all     us; a value below the one before it means that 2^31 us went by
mono         u64   0..31   *nanoseconds* after ``time_base``
                   32..47  x
                   48..62  y
                   63      polarity
evt3,        u16   12..15  code, see below: the words drive a small state machine
libcaer_cmp        0..11   payload
============ ===== ======= ======================================================================

============== ====== ============= ==============================================================
word           evt3   libcaer_cmp   payload
============== ====== ============= ==============================================================
time high      8      0             time, bits 12..23
time low       6      1             time, bits 0..11
line           0: y   2: x          bits 0..10: the coordinate that the following events share
event          2: x   3: y          bits 0..10: the other coordinate; bit 11: polarity
vector base    3: x   4: y          bits 0..10: the other coordinate of bit 0; bit 11: polarity
vector of 12   4      -             bit i: an event at base + i; base then moves on by 12
vector of 8    5      5             bit i (of 0..7): likewise; base then moves on by 8
anything else                       triggers, vendor words, padding: skipped
============== ====== ============= ==============================================================

Time in evt3 is the sensor's clock modulo 2^24 us; a time high that falls by more than 10 is a rollover.
The ROS decoder ignores ``time_base`` and counts rollovers from packet to packet; here ``time_base`` says
which of them it is, so that a packet decodes alone. Time in libcaer_cmp is `us`, starting at 0. Both are
written without vectors, and each buffer starts with all the state it needs (evt3: with the time of
``time_base``, even when empty). Limits: libcaer x, y < 32768 and 2147 s after ``time_base``; mono
y < 32768 and 4.29 s; evt3 and libcaer_cmp x, y < 2048 and 16 s.

Sources: ros-event-camera/event_camera_codecs (mono_encoder.h, evt3_types.h, evt3_decoder.h,
libcaer_decoder.h, libcaer_cmp_types.h, libcaer_cmp_decoder.h), ros-event-camera/event_camera_msgs
(README.md), and Prophesee's page on EVT 3.0.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from voltcam_client.errors import PacketError
from voltcam_client.word_stream import EVT3, LIBCAER_CMP, WORDS_SPAN_US, from_words, start_words, to_words

EVENT = np.dtype([("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "?")])
"""One event: time in us, pixel, polarity (True = ON). Arrays of it are sorted by ``t``."""

Events = npt.NDArray[np.void]
Buffer = bytes | bytearray | memoryview
Column = npt.NDArray[Any]

LIBCAER_WORD = np.dtype([("address", "<u4"), ("us", "<i4")])
LIBCAER_SPAN_US = 1 << 31
MONO_SPAN_US = (1 << 32) // 1000


def encode_libcaer(events: Events, time_base_us: int) -> bytes:
    us = _us_after(time_base_us, events, "libcaer", LIBCAER_SPAN_US)
    _check_pixels(events, "libcaer", x_limit=1 << 15, y_limit=1 << 15)
    words = np.empty(events.size, LIBCAER_WORD)
    words["address"] = _u4(events["x"]) << 17 | _u4(events["y"]) << 2 | _u4(events["p"]) << 1 | 1
    words["us"] = us
    return words.tobytes()


def decode_libcaer(buffer: Buffer, time_base_us: int) -> Events:
    words = _words(buffer, LIBCAER_WORD, "libcaer")
    address, us = words["address"], words["us"]
    t_us = us.astype(np.int64) + time_base_us
    fell = us[1:] < us[:-1]
    if fell.any():
        t_us[1:] += np.cumsum(fell) * LIBCAER_SPAN_US
    return _events(t_us, address >> 17, address >> 2 & 0x7FFF, address & 2)


def encode_mono(events: Events, time_base_us: int) -> bytes:
    ns = 1000 * _us_after(time_base_us, events, "mono", MONO_SPAN_US)
    _check_pixels(events, "mono", x_limit=1 << 16, y_limit=1 << 15)
    address = _u4(events["p"]) << 31 | _u4(events["y"]) << 16 | events["x"]
    return np.stack([ns.astype("<u4"), address.astype("<u4")], axis=1).tobytes()


def decode_mono(buffer: Buffer, time_base_us: int) -> Events:
    words = _words(buffer, np.dtype([("ns", "<u4"), ("address", "<u4")]), "mono")
    address = words["address"]
    t_us = words["ns"] // 1000 + np.int64(time_base_us)
    return _events(t_us, address & 0xFFFF, address >> 16 & 0x7FFF, address >> 31)


def encode_evt3(events: Events, time_base_us: int) -> bytes:
    us = _us_after(time_base_us, events, "evt3", WORDS_SPAN_US)
    _check_pixels(events, "evt3", x_limit=1 << 11, y_limit=1 << 11)
    words = to_words(EVT3, time_base_us, us + time_base_us, events["y"], events["x"], events["p"])
    return start_words(EVT3, time_base_us).tobytes() + words.tobytes()


def decode_evt3(buffer: Buffer, time_base_us: int) -> Events:
    t_us, y, x, p = from_words(EVT3, time_base_us, _words(buffer, np.dtype("<u2"), "evt3"))
    return _events(t_us, x, y, p)


def encode_libcaer_cmp(events: Events, time_base_us: int) -> bytes:
    us = _us_after(time_base_us, events, "libcaer_cmp", WORDS_SPAN_US)
    _check_pixels(events, "libcaer_cmp", x_limit=1 << 11, y_limit=1 << 11)
    return to_words(LIBCAER_CMP, 0, us, events["x"], events["y"], events["p"]).tobytes()


def decode_libcaer_cmp(buffer: Buffer, time_base_us: int) -> Events:
    us, x, y, p = from_words(LIBCAER_CMP, 0, _words(buffer, np.dtype("<u2"), "libcaer_cmp"))
    return _events(us + time_base_us, x, y, p)


class Encoding(NamedTuple):
    """Both ways between an EVENT array sorted by time and a buffer, given the packet's time base in us.

    Encoding raises PacketError for events that do not fit, decoding for a buffer cut in the middle of a word.
    """

    encode: Callable[[Events, int], bytes]
    decode: Callable[[Buffer, int], Events]


ENCODINGS = {
    "libcaer": Encoding(encode_libcaer, decode_libcaer),
    "mono": Encoding(encode_mono, decode_mono),
    "evt3": Encoding(encode_evt3, decode_evt3),
    "libcaer_cmp": Encoding(encode_libcaer_cmp, decode_libcaer_cmp),
}


def _u4(column: Column) -> Column:
    """Wide enough to shift."""
    return column.astype("<u4")


def _us_after(time_base_us: int, events: Events, encoding: str, span_us: int) -> Column:
    """The events' times after the base, (N,) int64."""
    us = events["t"] - time_base_us
    if us.size and not (us[0] >= 0 and (us[1:] >= us[:-1]).all()):
        raise PacketError(
            "a packet's events must be sorted by time and start at its time_base or later; sort them"
        )
    if us.size and us[-1] >= span_us:
        raise PacketError(
            f"{encoding} holds events up to {span_us / 1e6:.6g} s after time_base, not {us[-1] / 1e6:.6g} s; "
            "cut the events into smaller packets"
        )
    return us


def _check_pixels(events: Events, encoding: str, *, x_limit: int, y_limit: int) -> None:
    if events.size and (events["x"].max() >= x_limit or events["y"].max() >= y_limit):
        raise PacketError(
            f"{encoding} holds x below {x_limit} and y below {y_limit}, not x {events['x'].max()}, "
            f"y {events['y'].max()}; use mono or libcaer for large sensors"
        )


def _words(buffer: Buffer, word: np.dtype[np.generic], encoding: str) -> Column:
    if len(buffer) % word.itemsize:
        raise PacketError(
            f"{len(buffer)} bytes of {encoding} are no whole number of {word.itemsize}-byte words; cut short?"
        )
    return np.frombuffer(buffer, word)


def _events(t_us: Column, x: Column, y: Column, p: Column) -> Events:
    events = np.empty(t_us.size, EVENT)
    events["t"], events["x"], events["y"], events["p"] = t_us, x, y, p
    return events
