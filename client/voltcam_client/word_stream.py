"""The 16-bit word streams of evt3 and libcaer_cmp; `encodings` has their table and sources."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]


class WordCodes(NamedTuple):
    """The upper four bits of each kind of word."""

    time_high: int
    time_low: int
    line: int
    event: int
    vector_base: int
    vector_12: int
    vector_8: int


NO_CODE = 16  # four bits never say that
EVT3 = WordCodes(time_high=8, time_low=6, line=0, event=2, vector_base=3, vector_12=4, vector_8=5)
LIBCAER_CMP = WordCodes(
    time_high=0, time_low=1, line=2, event=3, vector_base=4, vector_12=NO_CODE, vector_8=5
)

LARGEST_STEP_BACK = 10  # of time high, in its units of 4096 us; a larger one is a rollover
WORDS_SPAN_US = 16_000_000  # 2^24 us, less what tells a rollover from a step back


def start_words(codes: WordCodes, t_us: int) -> Array:
    """Time high and time low of t_us, (2,) uint16."""
    return np.array([codes.time_high << 12 | t_us >> 12 & 0xFFF, codes.time_low << 12 | t_us & 0xFFF], "<u2")


def to_words(codes: WordCodes, start_us: int, t_us: Array, line: Array, other: Array, p: Array) -> Array:
    """(N,) columns to uint16 words: each event, after its time high, time low and line where these change.

    `start_us` is the time the decoder starts from; the other state is written with the first event.
    """
    columns = np.empty((t_us.size, 4), "<u2")
    columns[:, 0] = codes.time_high << 12 | t_us >> 12 & 0xFFF
    columns[:, 1] = codes.time_low << 12 | t_us & 0xFFF
    columns[:, 2] = codes.line << 12 | line
    columns[:, 3] = codes.event << 12 | p.astype(np.uint16) << 11 | other
    needed = np.ones(columns.shape, bool)
    needed[1:, :3] = columns[1:, :3] != columns[:-1, :3]
    needed[:1, 0] = columns[:1, 0] != start_words(codes, start_us)[0]
    needed[:, 1] |= needed[:, 0]  # decoders differ on what a new time high does to the low bits
    return columns[needed]


def from_words(codes: WordCodes, start_us: int, words: Array) -> tuple[Array, Array, Array, Array]:
    """Uint16 words to (N,) columns t_us, line, other, p. Before the first words of time it is `start_us`."""
    code, payload = words >> 12, words & 0xFFF
    at = np.flatnonzero(code == codes.event)
    other, p = payload[at] & 0x7FF, payload[at] >> 11
    if (is_vector := (code == codes.vector_8) | (code == codes.vector_12)).any():
        vector_at, vector_other, vector_p = _from_vectors(codes, code, payload, np.flatnonzero(is_vector))
        order = np.argsort(np.concatenate([at, vector_at]), kind="stable")
        at = np.concatenate([at, vector_at])[order]
        other = np.concatenate([other, vector_other])[order]
        p = np.concatenate([p, vector_p])[order]
    high = _latest(code == codes.time_high, _unrolled(start_us >> 12, payload[code == codes.time_high]), at)
    is_low, is_line = code == codes.time_low, code == codes.line
    low = _latest(is_low, np.append(start_us & 0xFFF, payload[is_low]), at)
    line = _latest(is_line, np.append(0, payload[is_line] & 0x7FF), at)
    return high << 12 | low, line, other, p


def _latest(is_kind: Array, values: Array, at: Array) -> Array:
    """For each position `at`, the value of the last word of a kind before it.

    `values` holds the value before any such word, then one for each.
    """
    latest: Array = values[np.cumsum(is_kind)[at]]
    return latest


def _unrolled(start: int, time_high: Array) -> Array:
    """12-bit time highs to whole ones, (1 + N,) int64 from `start` on: each large fall is a rollover."""
    high = np.append(start & 0xFFF, time_high.astype(np.int64))
    rollovers = np.cumsum(np.diff(high) < -LARGEST_STEP_BACK)
    high += start & ~0xFFF
    high[1:] += rollovers << 12
    return high


def _from_vectors(
    codes: WordCodes, code: Array, payload: Array, vectors: Array
) -> tuple[Array, Array, Array]:
    """Position, other coordinate and polarity of each event of the vector words at positions `vectors`."""
    is_12, is_base = code == codes.vector_12, code == codes.vector_base
    # How far all vectors before a word have moved the base, rebased at each vector base.
    width = np.where(is_12, 12, np.where(code == codes.vector_8, 8, 0))
    moved = np.cumsum(width) - width
    moved_since_base = moved[vectors] - _latest(is_base, np.append(0, moved[is_base]), vectors)
    base = _latest(is_base, np.append(0, payload[is_base].astype(np.int64)), vectors)
    mask = np.where(is_12[vectors], payload[vectors], payload[vectors] & 0xFF)
    vector, bit = np.nonzero(mask[:, np.newaxis] >> np.arange(12) & 1)
    other = (base & 0x7FF) + moved_since_base
    return vectors[vector], other[vector] + bit, (base >> 11)[vector]
