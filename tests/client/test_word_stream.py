"""The 16-bit word streams, word by word: state, rollovers and vectors. Whole buffers: test_encodings."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from voltcam_client.word_stream import (
    EVT3,
    LARGEST_STEP_BACK,
    LIBCAER_CMP,
    NO_CODE,
    WORDS_SPAN_US,
    WordCodes,
    from_words,
    start_words,
    to_words,
)

BOTH = pytest.mark.parametrize("codes", [EVT3, LIBCAER_CMP], ids=["evt3", "libcaer_cmp"])
Row = tuple[int, int, int, bool]  # t_us, line, other, p
rows = st.tuples(st.integers(0, 9000), st.integers(0, 2047), st.integers(0, 2047), st.booleans())


def words_of(*words: tuple[int, int]) -> np.ndarray:
    """(code, payload) each."""
    return np.array([code << 12 | payload for code, payload in words], "<u2")


def decoded(codes: WordCodes, start_us: int, words: np.ndarray) -> list[Row]:
    return list(zip(*(column.tolist() for column in from_words(codes, start_us, words)), strict=True))  # type: ignore[arg-type]


def encoded(codes: WordCodes, start_us: int, events: list[Row]) -> np.ndarray:
    t_us, line, other, p = (np.array([row[i] for row in events], np.int64) for i in range(4))
    return to_words(codes, start_us, t_us, line, other, p.astype(bool))


@BOTH
@given(
    steps=st.lists(rows, max_size=30),
    start_us=st.integers(0, 2**52) | st.sampled_from([2**24 - 1, 4095, 1_700_000_000_000_000]),
)
def test_events_come_back_whatever_the_clock_shows(codes: WordCodes, steps: list[Row], start_us: int) -> None:
    t_us, events = start_us, []
    for dt, *rest in steps:
        t_us += dt
        events.append((t_us, *rest))
    assert decoded(codes, start_us, encoded(codes, start_us, events)) == events


@BOTH
def test_a_word_is_written_only_where_it_says_something_new(codes: WordCodes) -> None:
    events = [(5, 7, 1, True), (5, 7, 2, False), (6, 7, 2, False), (6, 8, 2, False), (4096, 8, 2, False)]
    kinds = (encoded(codes, 0, events) >> 12).tolist()
    low, line, event, high = codes.time_low, codes.line, codes.event, codes.time_high
    assert kinds == [low, line, event, event, low, event, line, event, high, low, event]


@BOTH
def test_time_high_comes_first_where_the_decoder_starts_elsewhere(codes: WordCodes) -> None:
    event = [(4096, 0, 0, True)]
    assert encoded(codes, 4096, event)[0] >> 12 == codes.time_low
    assert encoded(codes, 0, event)[0] >> 12 == codes.time_high


@BOTH
@given(st.integers(0, 2**60))
def test_start_words_are_the_lower_24_bits(codes: WordCodes, t_us: int) -> None:
    high, low = start_words(codes, t_us).tolist()
    assert (high >> 12, low >> 12) == (codes.time_high, codes.time_low)
    assert (high & 0xFFF) << 12 | low & 0xFFF == t_us % 2**24


@BOTH
@pytest.mark.parametrize(
    ("back", "t_us"),
    [
        (0, 100 << 12),
        (LARGEST_STEP_BACK, 90 << 12),  # a step back of the sensor's clock
        (LARGEST_STEP_BACK + 1, 4096 + 89 << 12),  # a rollover
    ],
)
def test_only_a_large_step_back_is_a_rollover(codes: WordCodes, back: int, t_us: int) -> None:
    words = words_of((codes.time_high, 100), (codes.time_high, 100 - back), (codes.event, 3))
    assert decoded(codes, 0, words) == [(t_us, 0, 3, False)]


@BOTH
def test_before_any_word_of_time_it_is_the_start(codes: WordCodes) -> None:
    start_us = 1_700_000_000_123_456
    words = words_of((codes.event, 5), (codes.time_low, 9), (codes.event, 0x806))
    expected = [(start_us, 0, 5, False), (start_us & ~0xFFF | 9, 0, 6, True)]
    assert decoded(codes, start_us, words) == expected


@BOTH
def test_a_vector_moves_its_base_on_and_keeps_its_polarity(codes: WordCodes) -> None:
    words = words_of(
        (codes.vector_base, 0x800 | 100), (codes.vector_8, 0b1000_0001), (codes.event, 3),
        (codes.vector_8, 0xF02), (codes.vector_base, 50), (codes.vector_8, 1),
    )  # fmt: skip
    others = [(100, True), (107, True), (3, False), (109, True), (50, False)]
    assert decoded(codes, 0, words) == [(0, 0, other, p) for other, p in others]


def test_a_vector_of_twelve_is_evt3_s_alone() -> None:
    assert LIBCAER_CMP.vector_12 == NO_CODE
    words = words_of((EVT3.vector_base, 20), (EVT3.vector_12, 0x801), (EVT3.vector_8, 1))
    assert [row[2] for row in decoded(EVT3, 0, words)] == [20, 31, 32]


@BOTH
def test_words_of_other_kinds_are_skipped(codes: WordCodes) -> None:
    known = set(codes)
    others = [(code, 0xABC) for code in range(16) if code not in known]
    words = words_of((codes.line, 7), *others, (codes.event, 5), *others)
    assert decoded(codes, 0, words) == [(0, 7, 5, False)]


def test_the_span_leaves_room_to_tell_a_rollover() -> None:
    """The largest time high in a span, from the smallest, is never within the step back of a rollover."""
    assert WORDS_SPAN_US + (LARGEST_STEP_BACK + 1) * 4096 < 2**24
