"""Findings on the sensor and its readout: saturation, pixels at fault, gaps, frame-locked events, rows."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..light.grey import WHITE_DN
from ..light.scale import white_dn
from ..windows import Windows, around, joined, total_us, within
from .bursts import FrameBurst
from .finding import EventsLate, Finding
from .lag import Lag
from .row_scan import RowScan
from .subject import Subject
from .token_scan import TokenScan

_CLIPPED = 0.01
_TEXTURE_DN = 10.0
_BLACK_DN = 16.0
_STILL = 0.002  # share of samples in which anything changes: no more than noise leaves
_FEWEST_PER_CHANGE = 0.2  # events per change of ln L by 1: thresholds are 0.1 to 0.6, so 2 to 10 are usual
_GAP_US = 5000
_GAP_EVENTS = 50.0  # that the light makes expect in a gap: e^-50 by chance
_REVERSED = 0.4  # correlation: light that comes again has some .2 the wrong way round


def light(subject: Subject) -> list[Finding]:
    """Lens cap, saturation, and whether events follow the light at all."""
    images = subject.footage.frames
    mean = subject.light.mean_dn
    texture = float(np.quantile(mean, 0.99) - np.quantile(mean, 0.01))
    bright = float(np.quantile(mean, 0.99))
    changing = subject.light.changing_share
    numbers = {
        "texture_dn": texture,
        "bright_dn": bright,
        "changing_share": changing,
        "noise_dn": subject.light.noise_dn,
    }
    if changing < _STILL and (texture < _TEXTURE_DN or bright < _BLACK_DN):
        words = f"no picture: grey levels differ by {texture:.0f}, nothing changes; take the lens cap off"
        return [Finding("light", "fatal", words, numbers)]
    findings = []
    if changing < _STILL:
        words = (
            "nothing moves: only leak and noise at rest can be seen; move the camera or something before it"
        )
        findings.append(Finding("light", "limits", words, numbers))
    else:
        total = float(subject.light.change.sum())
        response = np.count_nonzero(~subject.at_rest & (subject.interval >= 0)) / total
        numbers["events_per_log_unit"] = response
        if response < _FEWEST_PER_CHANGE:
            words = f"the light changes, the events do not follow: {response:.2g} per change of ln L by 1"
            findings.append(Finding("light", "fatal", f"{words}; are they of this scene?", numbers))
        else:
            words = f"{changing:.1%} of the samples change; noise of a frame: {subject.light.noise_dn:.1f} DN"
            findings.append(Finding("light", "good", words, numbers))
    white = white_dn(images)
    dark, full = float(np.mean(images == 0)), float(np.mean(images >= white))
    numbers = {"dark_share": dark, "full_share": full, "white_dn": white}
    clipped = max(dark, full) > _CLIPPED
    highest = f"{white:.0f} or more, the white of these frames" if white < WHITE_DN else "255"
    words = f"{dark:.1%} of the grey levels are 0, {full:.1%} are {highest}"
    words += ": the light there is not known" if clipped else ""
    findings.append(Finding("saturation", "limits" if clipped else "good", words, numbers))
    return findings


def clock(subject: Subject, lag: Lag) -> Finding:
    """Whether the events follow the frames' light, and how much later."""
    numbers = {key: float(value) for key, value in vars(lag).items() if key != "parts_us"}
    if lag.reversed > max(_REVERSED, 2 * lag.correlation):
        words = "the events follow the light with ON and OFF exchanged: turn their polarity round"
        return Finding("clock", "fatal", words, numbers)
    ms, error_ms, period_ms = lag.lag_us / 1000, lag.uncertainty_us / 1000, subject.period_us / 1000
    if not lag.is_sure:
        if subject.light.changing_share < _STILL:
            return Finding("clock", "limits", "nothing moves, so the clocks cannot be compared", numbers)
        words = (
            "the events do not follow the light at any lag within 5 s: frames and events are on different "
        )
        return Finding("clock", "fatal", f"{words}clocks, or not of one scene", numbers)
    words = f"events come {ms:.1f} +- {error_ms:.1f} ms after the light of the frames"
    late_us, early_us = max(subject.period_us, 20_000), max(subject.period_us / 2, 10_000)
    sure_us = 3 * lag.uncertainty_us
    if lag.lag_us - sure_us > late_us or lag.lag_us + sure_us < -early_us:
        words = f"frames and events are on different clocks: {words}; shift the frames' times by it"
        return EventsLate("clock", "fatal", words, {**numbers, "late_us": lag.lag_us})
    drifts = abs(lag.drift_ppm) > 2000 and abs(lag.drift_ppm) > 5 * lag.drift_uncertainty_ppm
    if drifts:
        words += f"; the clocks drift apart by {lag.drift_ppm:.0f} ppm"
        return Finding("clock", "limits", words, numbers)
    odd = abs(ms) > period_ms / 2
    return Finding("clock", "limits" if odd else "good", words, numbers)


def event_gaps(subject: Subject) -> Finding:
    """Silences of the whole array while the light changed."""
    t_us, light = subject.t_us, subject.light
    change = np.array([np.abs(step).sum(dtype=np.float32) for step in light.step], np.float64)
    per_change = np.count_nonzero(subject.interval >= 0) / max(1.0, float(change.sum()))
    expected = np.concatenate([[0.0], np.cumsum(change)]) * per_change
    missed = np.diff(np.interp(t_us, light.t_us, expected))
    places = np.flatnonzero((np.diff(t_us) > _GAP_US) & (missed > _GAP_EVENTS))
    gaps = [(int(t_us[i]), int(t_us[i + 1])) for i in places]
    total_ms = sum(end - begin for begin, end in gaps) / 1000
    numbers = {"gaps_us": gaps[:100], "gaps": len(gaps), "total_ms": total_ms}
    if not gaps:
        return Finding("event gaps", "good", "no gap in the events", numbers)
    words = f"{len(gaps)} gaps, {total_ms:.0f} ms of silence in all while the light changed: events were lost"
    return Finding("event gaps", "limits", words, numbers)


def faulty_pixels(subject: Subject, hot: NDArray[np.bool_], silent: NDArray[np.bool_]) -> list[Finding]:
    """Which pixels are hot, which silent."""
    counts = subject.all_counts
    ys, xs = np.nonzero(hot)
    order = np.argsort(-counts[hot])
    listed = [(int(xs[i]), int(ys[i])) for i in order]
    share = float(counts[hot].sum() / max(1, counts.sum()))
    words = f"{len(listed)} hot pixels with {share:.1%} of the events" if listed else "no hot pixel"
    words += f", first x={listed[0][0]} y={listed[0][1]}" if listed else ""
    first = Finding("hot pixels", "limits" if listed else "good", words, {"xy": listed, "event_share": share})
    ys, xs = np.nonzero(silent)
    where = [(int(x), int(y)) for x, y in zip(xs, ys, strict=True)]
    words = f"{len(where) or 'no'} pixels silent where the light changed"
    return [first, Finding("silent pixels", "limits" if where else "good", words, {"xy": where})]


def frame_locked(subject: Subject, bursts: Sequence[FrameBurst], windows: Windows) -> Finding:
    """Events that come with the frames. windows: what to leave out, the lulls behind the bursts, too."""
    crowded = around(subject.light.t_us, joined([(one.begin_us, one.end_us) for one in bursts]))
    inside = within(subject.t_us, crowded)
    span = float(subject.light.t_us[-1] - subject.light.t_us[0])
    time_share = total_us(windows) / span
    shares = {
        "at_rest": float(inside[subject.at_rest].mean()) if subject.at_rest.any() else 0.0,
        "all": float(inside.mean()),
    }
    numbers = {
        "windows": [vars(burst) for burst in bursts],
        "event_share": shares,
        "time_share": time_share,
    }
    if not bursts:
        return Finding("frame-locked events", "good", "events do not come with the frames", numbers)
    where = ", ".join(f"{one.begin_us}..{one.end_us} us ({_times(one)})" for one in bursts[:4])
    where += f" and {len(bursts) - 4} more" if len(bursts) > 4 else ""
    words = (
        f"events are locked to the frames, {where} after a frame's time: {shares['at_rest']:.0%} of the "
        f"events at rest, {shares['all']:.0%} of all; masking takes {time_share:.0%} of the time"
    )
    return Finding("frame-locked events", "limits", words, numbers)


def _times(burst: FrameBurst) -> str:
    polarity, ratio = ("ON", burst.on) if burst.on >= burst.off else ("OFF", burst.off)
    return f"{polarity} x{ratio:.1f}"


def row_readout(subject: Subject, scan: RowScan | None, token: TokenScan | None = None) -> Finding:
    """Whether rows are read together, or one after the other, with each frame or all the time."""
    same_t, same_row = np.diff(subject.t_us) == 0, np.diff(subject.y) == 0
    together = float(same_row[same_t].mean()) if same_t.sum() >= 100 else 0.0
    apart = float(same_row[~same_t].mean()) if not same_t.all() else 0.0
    numbers = {
        "shared_stamp_share": float(same_t.mean()),
        "in_one_row": together,
        "in_one_row_otherwise": apart,
        "us_per_row": None if scan is None else scan.us_per_row,
        "token": None if token is None else vars(token),
    }
    words = []
    if token is not None:
        words.append(token.in_words())
    if scan is not None:
        words.append(f"events at rest run over the rows with each frame, {scan.us_per_row:.2f} us per row")
    if together > max(0.1, 3 * apart):
        shared = f"{same_t.mean():.0%} of the events have the time of the one before"
        words.append(
            f"rows are read together: {shared}, and {together:.0%} of those its row ({apart:.1%} else)"
        )
    text = "; ".join(words) or "no sign that rows are read together"
    return Finding("row readout", "limits" if words else "good", text, numbers)
