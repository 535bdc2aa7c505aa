"""The part of a recording that is looked at: of its time, and of its columns."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats import Recording

from .clock import origin_us

MOST_SAMPLES = 3_500_000  # pixels x frames, all of 60 x 60 pixels for 10 s at 100 frames/s
MOST_EVENTS = 200_000
MOST_STEPS = 15_000_000  # pixels x steps that effects of the camera file ask the simulator for
LONGEST_SILENCE_US = 100_000  # at an end of a recording: longer, it is none of the camera's


def cut(recording: Recording, seconds: float) -> Recording:
    """The first seconds of it that have both, events between frames and frames about events, on a clock that
    begins near its first frame: where a camera gives no events yet, it is not one that is silent."""
    assert recording.frame_t_us is not None
    assert recording.frames is not None
    origin, t_us = origin_us(recording), recording.events["t"]
    first, last = _about(recording.frame_t_us, t_us)
    last = min(last, recording.frame_t_us[first] + seconds * 1e6)
    kept = (recording.frame_t_us >= recording.frame_t_us[first]) & (recording.frame_t_us <= last)
    frame_t_us = recording.frame_t_us[kept]
    events = recording.events[(t_us >= frame_t_us[0]) & (t_us <= frame_t_us[-1])].copy()
    events["t"] -= origin
    exposure_us = recording.exposure_us
    return replace(
        recording,
        frames=recording.frames[kept],
        frame_t_us=frame_t_us - origin,
        exposure_us=None if exposure_us is None else exposure_us[kept] - origin,
        events=events,
    )


def _about(frame_t_us: NDArray[np.int64], t_us: NDArray[np.int64]) -> tuple[int, float]:
    """The last frame before the events (its index), and the time of the first one after them; of all frames,
    where these are not long without any."""
    inside = t_us[(t_us >= frame_t_us[0]) & (t_us <= frame_t_us[-1])]
    first, last = 0, len(frame_t_us) - 1
    if inside.size and inside[0] - frame_t_us[0] > LONGEST_SILENCE_US:
        first = int(np.searchsorted(frame_t_us, inside[0], side="right")) - 1
    if inside.size and frame_t_us[-1] - inside[-1] > LONGEST_SILENCE_US:
        last = int(np.searchsorted(frame_t_us, inside[-1]))
    return first, float(frame_t_us[last])


def sample(recording: Recording, most_samples: int, step_us: float = np.inf) -> NDArray[np.int64]:
    """Columns to look at, ascending: all, or two strips, where light changes most and where it does little.

    As many as samples of light (pixels x frames), MOST_EVENTS, and MOST_STEPS of step_us allow. Rows are kept
    whole and complete, since readout goes by rows.
    """
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    steps = recording.frames[0].size * float(np.ptp(recording.frame_t_us)) / step_us
    share = min(
        most_samples / recording.frames.size,
        MOST_EVENTS / max(len(recording.events), 1),
        MOST_STEPS / max(steps, 1.0),
    )
    wide = max(6, int(share * recording.width / 2))
    if share >= 1 or 3 * wide > recording.width:  # nearly all: then all
        return np.arange(recording.width)
    grey = recording.frames[:: max(1, len(recording.frames) // 50)].astype(np.float32)
    change = np.abs(np.diff(np.log(grey + 20), axis=0)).mean(axis=(0, 1))
    strips = change[: recording.width // wide * wide].reshape(-1, wide).mean(axis=1)
    order = np.argsort(-strips, kind="stable")
    chosen = sorted({int(order[0]), int(order[max(1, len(order) * 2 // 3)])})
    return np.concatenate([np.arange(wide) + wide * strip for strip in chosen])


def in_columns(recording: Recording, columns: NDArray[np.int64]) -> Recording:
    """The recording of a sensor that has only these columns."""
    place = np.full(recording.width, -1)
    place[columns] = np.arange(len(columns))
    events = recording.events[place[recording.events["x"]] >= 0].copy()
    events["x"] = place[events["x"]]
    assert recording.frames is not None
    return replace(recording, events=events, frames=recording.frames[:, :, columns], width=len(columns))
