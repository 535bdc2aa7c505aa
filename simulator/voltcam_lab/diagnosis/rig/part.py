"""The part of a recording that is looked at: of its time, and of its columns."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...light.grey import USUAL_DARK_DN
from ...recordings import Footage
from .clock import origin_us
from .settings import RecordingSettings


def cut(footage: Footage, settings: RecordingSettings) -> Footage:
    """The first seconds of it that have both, events between frames and frames about events, on a clock that
    begins near its first frame: where a camera gives no events yet, it is not one that is silent."""
    origin, t_us = origin_us(footage), footage.events["t"]
    first, last = _about(footage.frame_t_us, t_us, settings.longest_silence_us)
    last = min(last, footage.frame_t_us[first] + settings.seconds * 1e6)
    kept = (footage.frame_t_us >= footage.frame_t_us[first]) & (footage.frame_t_us <= last)
    frame_t_us = footage.frame_t_us[kept]
    events = footage.events[(t_us >= frame_t_us[0]) & (t_us <= frame_t_us[-1])].copy()
    events["t"] -= origin
    exposure_us = footage.exposure_us
    return replace(
        footage,
        frames=footage.frames[kept],
        frame_t_us=frame_t_us - origin,
        exposure_us=None if exposure_us is None else exposure_us[kept] - origin,
        events=events,
    )


def _about(
    frame_t_us: NDArray[np.int64], t_us: NDArray[np.int64], longest_silence_us: int
) -> tuple[int, float]:
    """The last frame before the events (its index), and the time of the first one after them; of all frames,
    where these are not long without any."""
    inside = t_us[(t_us >= frame_t_us[0]) & (t_us <= frame_t_us[-1])]
    first, last = 0, len(frame_t_us) - 1
    if inside.size and inside[0] - frame_t_us[0] > longest_silence_us:
        first = int(np.searchsorted(frame_t_us, inside[0], side="right")) - 1
    if inside.size and frame_t_us[-1] - inside[-1] > longest_silence_us:
        last = int(np.searchsorted(frame_t_us, inside[-1]))
    return first, float(frame_t_us[last])


def sample(footage: Footage, settings: RecordingSettings, step_us: float = np.inf) -> NDArray[np.int64]:
    """Columns to look at, ascending: all, or two strips, where light changes most and where it does little.

    Strips have as many as the settings allow samples of light (pixels x frames), events, and steps of
    step_us. Rows are kept whole and complete, since readout goes by rows.
    """
    steps = footage.frames[0].size * float(np.ptp(footage.frame_t_us)) / step_us
    of_events = settings.most_events / max(len(footage.events), 1)
    share = min(
        settings.most_samples / footage.frames.size,
        settings.most_steps / max(steps, 1.0),
        1.0 if of_events >= settings.whole_share else of_events,
    )
    wide = max(settings.narrowest_strip, int(share * footage.width / 2))
    if share >= 1 or 3 * wide > footage.width:  # nearly all: then all
        return np.arange(footage.width)
    grey = footage.frames[:: max(1, len(footage.frames) // settings.compared_frames)].astype(np.float32)
    change = np.abs(np.diff(np.log(grey + USUAL_DARK_DN), axis=0)).mean(axis=(0, 1))
    strips = change[: footage.width // wide * wide].reshape(-1, wide).mean(axis=1)
    order = np.argsort(-strips, kind="stable")
    chosen = sorted({int(order[0]), int(order[max(1, len(order) * 2 // 3)])})
    return np.concatenate([np.arange(wide) + wide * strip for strip in chosen])


def in_columns(footage: Footage, columns: NDArray[np.int64]) -> Footage:
    """The recording of a sensor that has only these columns."""
    place = np.full(footage.width, -1)
    place[columns] = np.arange(len(columns))
    events = footage.events[place[footage.events["x"]] >= 0].copy()
    events["x"] = place[events["x"]]
    return replace(footage, events=events, frames=footage.frames[:, :, columns], width=len(columns))
