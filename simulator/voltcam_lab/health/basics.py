"""Findings that need no picture of the light: what is there, for how long, with which gaps and stamps."""

import numpy as np
from numpy.typing import NDArray

from ..recordings import Footage
from .finding import Finding, Severity

SHORTEST_S = 1.5  # of frames and events together: below, nothing is fixed to better than a factor
SHORT_S = 10.0
_FEWEST_EVENTS = 1000
_FEWEST_FRAMES = 10
_STEPS_US = (1000, 500, 256, 250, 200, 128, 125, 100, 64, 50, 32, 25, 20, 16, 10, 8, 5, 4, 2)


def missing(footage: Footage) -> list[Finding]:
    """Fatal: what a calibration cannot do without and the recording does not have."""
    found = []
    frames = len(footage.frames)
    if frames < _FEWEST_FRAMES:
        words = "only one frame" if frames == 1 else f"only {frames} frames"
        words += ": record frames and events of the same camera together (DAVIS: switch the frames on)"
        found.append(Finding("frames", "fatal", words, {"frames": frames}))
    count = footage.events.size
    if count < _FEWEST_EVENTS:
        words = "no events" if count == 0 else f"only {count} events"
        words += ": switch the event output on, take the lens cap off, and move something in front of it"
        found.append(Finding("events", "fatal", words, {"events": count}))
    height, width = footage.frames.shape[1:]
    if (width, height) != (footage.width, footage.height):
        words = f"frames are {width}x{height}, events {footage.width}x{footage.height}: "
        words += "frames must come from the same pixels; rectify neither"
        numbers = {"frames": [width, height], "events": [footage.width, footage.height]}
        found.append(Finding("size", "fatal", words, numbers))
    back = np.flatnonzero(np.diff(footage.frame_t_us) <= 0)
    if back.size:
        words = f"the time of frame {back[0] + 1} does not come after the one before: sort the frames"
        found.append(Finding("frame times", "fatal", words, {"frame": int(back[0]) + 1}))
    return found


def overlap(frame_t_us: NDArray[np.int64], t_us: NDArray[np.int64]) -> list[Finding]:
    """Whether frames and events are of one time at all, and how long of it."""
    begin, end = max(frame_t_us[0], t_us[0]), min(frame_t_us[-1], t_us[-1])
    seconds = float(end - begin) / 1e6
    spans = [float(t[-1] - t[0]) / 1e6 for t in (frame_t_us, t_us)]
    numbers = {"overlap_s": seconds, "frames_s": spans[0], "events_s": spans[1]}
    if seconds <= 0 and min(spans) > 0:
        apart = "frames begin" if frame_t_us[0] > t_us[-1] else "events begin"
        words = f"frames and events are on different clocks: {apart} {-seconds:.6g} s after the others' end"
        return [Finding("clock", "fatal", f"{words}; stamp both by one clock", numbers)]
    severity: Severity = "fatal" if seconds < SHORTEST_S else "limits" if seconds < SHORT_S else "good"
    exact = f"{seconds:.4g}" if severity == "fatal" else f"{seconds:.1f}"
    words = f"{exact} s with frames and events"
    if severity != "good":
        words += f", too short: record {SHORTEST_S:g} s at least" if severity == "fatal" else ""
        words += "; a minute is better"
    findings = [Finding("duration", severity, words, numbers)]
    if seconds < 0.5 * min(spans):
        words = f"frames and events share {seconds:.1f} s of {spans[0]:.1f} s and {spans[1]:.1f} s"
        findings.append(Finding("overlap", "limits", f"{words}: was one of them started late?", numbers))
    return findings


def frame_times(footage: Footage) -> list[Finding]:
    """Rate, jitter and gaps of the frames, and which moment of the exposure their stamps are."""
    t_us = footage.frame_t_us
    intervals = np.diff(t_us)
    period = float(np.median(intervals))
    lost = np.maximum(np.rint(intervals / period).astype(int) - 1, 0)
    whole = intervals[lost == 0]
    jitter_us = float(np.sqrt(np.mean((whole - period) ** 2)))
    numbers = {
        "fps": 1e6 / period,
        "period_us": period,
        "jitter_us": jitter_us,
        "gaps": int((lost > 0).sum()),
        "lost_frames": int(lost.sum()),
    }
    rate = f"{1e6 / period:.1f} frames per second, jitter {jitter_us:.0f} us"
    steady = jitter_us < 0.05 * period
    findings = [Finding("frame rate", "good" if steady else "limits", rate, numbers)]
    if lost.any():
        words = f"{lost.sum()} frames missing in {(lost > 0).sum()} places: the light there is not known"
        findings.append(Finding("frame gaps", "limits", words, numbers))
    else:
        findings.append(Finding("frame gaps", "good", "no frame missing", numbers))
    return [*findings, _stamps(footage.exposure_us, t_us)]


def _stamps(exposure_us: NDArray[np.int64] | None, t_us: NDArray[np.int64]) -> Finding:
    if exposure_us is None:
        words = "no exposure times in the file: whether a frame's time is the begin, middle or end is unknown"
        return Finding("exposure", "limits", words, {"meaning": "unknown"})
    length = exposure_us[:, 1] - exposure_us[:, 0]
    place = float(np.median((t_us - exposure_us[:, 0]) / np.maximum(length, 1)))
    nearest = {0.0: "begin", 0.5: "middle", 1.0: "end"}
    meaning = nearest[min(nearest, key=lambda share: abs(share - place))]
    numbers = {"meaning": meaning, "place": place, "exposure_us": [int(length.min()), int(length.max())]}
    spread = f"{length.min()} us" if np.ptp(length) < 2 else f"{length.min()} to {length.max()} us"
    words = f"{spread}; a frame's time is the {meaning} of its exposure"
    return Finding("exposure", "good", words, numbers)


def stamp_step_us(t_us: NDArray[np.int64]) -> int:
    """The largest step on which all but one in a thousand of the event times (n,) lie."""
    for step in _STEPS_US:
        if np.bincount(t_us % step).max() >= 0.999 * t_us.size:
            return step
    return 1


def stamp_step(step_us: int) -> Finding:
    """Whether event times are fine enough."""
    words = f"event times in steps of {step_us} us"
    severity: Severity = "good" if step_us <= 10 else "limits"
    if severity == "limits":
        words += ": short intervals and the refractory period are blurred"
    return Finding("timestamp quantum", severity, words, {"quantum_us": step_us})


def polarities(on: NDArray[np.bool_]) -> Finding:
    """How many events are ON."""
    share = float(on.mean())
    numbers = {"on_share": share, "on_per_off": float(on.sum() / max(1, (~on).sum()))}
    if 0.02 < share < 0.98:
        return Finding("polarity", "good", f"{share:.0%} of the events are ON", numbers)
    words = (
        f"{share:.1%} of the events are ON: one polarity is all but missing; look at the thresholds' biases"
    )
    return Finding("polarity", "limits", words, numbers)
