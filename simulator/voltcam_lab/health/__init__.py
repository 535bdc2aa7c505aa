"""A report on a recording before it is used: what is wrong with it, and what it can and cannot determine.

    health = examine(load("street.aedat4"))
    print(health.text())

`frame_mask` and `hot_pixels` are what a calibration leaves out; `exposure_windows` are the same for all rows.
"""

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats import Recording
from voltcam_lab.health import basics, sensor
from voltcam_lab.health.bursts import find_mask, find_windows, mask_of
from voltcam_lab.health.content import Content
from voltcam_lab.health.finding import Determination, Finding, Health
from voltcam_lab.health.pixels import find_hot, find_silent
from voltcam_lab.health.subject import Subject, subject_of, within
from voltcam_lab.windows import Mask

__all__ = ["Determination", "Finding", "Health", "examine", "exposure_windows", "frame_mask", "hot_pixels"]


def examine(recording: Recording) -> Health:
    """The whole report; `recording` as voltcam_lab.recordings.load gives it. What is fatal ends it early."""
    findings = basics.missing(recording)
    t_us = recording.events["t"]
    if findings or recording.frame_t_us is None:
        return Health(tuple(findings))
    findings += basics.overlap(recording.frame_t_us, t_us)
    if any(finding.severity == "fatal" for finding in findings):
        return Health(tuple(findings))
    findings += basics.frame_times(recording)
    findings += [basics.quantum(t_us), basics.polarities(recording.events["p"])]
    subject = subject_of(recording)
    findings += sensor.light(subject)
    if any(finding.severity == "fatal" for finding in findings):
        return Health(tuple(findings))
    findings += [sensor.clock(subject), sensor.event_gaps(subject)]
    windows = find_windows(subject)
    mask = mask_of(windows, subject.light.t_us)
    hot, silent = _hot(subject, mask), find_silent(_counts(subject), subject.light.change)
    findings += [*sensor.faulty_pixels(subject, hot, silent), *sensor.frame_locked(subject, windows, mask)]
    clean = ~within(subject.t_us, mask) & ~hot[recording.events["y"], recording.events["x"]]
    span_us = float(subject.light.t_us[-1] - subject.light.t_us[0])
    masked_share = float((mask[:, 1] - mask[:, 0]).sum()) / span_us
    content = Content(subject, clean, min(masked_share, 1.0))
    findings += content.findings()
    health = Health(tuple(findings))
    return Health(health.findings, tuple(content.determinations())) if health.usable else health


def exposure_windows(recording: Recording) -> NDArray[np.int64]:
    """(M, 2) int64, begin and end in us of the times around frames at which the camera's own readout makes
    events; sorted, not overlapping; (0, 2) where there are none. ValueError without frames."""
    subject = subject_of(recording)
    return mask_of(find_windows(subject), subject.light.t_us)


def frame_mask(recording: Recording) -> Mask:
    """The same times, narrower where rows take turns: each row's own. ValueError without frames."""
    return find_mask(subject_of(recording))


def hot_pixels(recording: Recording) -> NDArray[np.bool_]:
    """(H, W): pixels whose events neither light nor neighbours explain. ValueError without frames."""
    subject = subject_of(recording)
    return _hot(subject, mask_of(find_windows(subject), subject.light.t_us))


def _hot(subject: Subject, mask: NDArray[np.int64]) -> NDArray[np.bool_]:
    counts = subject.counts(~within(subject.t_us, mask))
    return find_hot(counts, subject.light.change)


def _counts(subject: Subject) -> NDArray[np.int64]:
    return subject.counts(np.ones(subject.t_us.size, np.bool_))
