"""`inspect`: all that is found out about a recording before it is used, each part once."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..recordings import Footage
from ..windows import Mask, Windows, total_us, within
from . import basics, sensor
from .bursts import FrameBurst, Moments, bursts_of, find_moments, row_mask, windows_of
from .bus import Bus, find_bus
from .content import Content
from .finding import Finding, Health
from .lag import Lag, find_lag
from .light_change import LightChange
from .pixels import find_hot, find_silent
from .row_scan import RowScan, find_row_scan
from .subject import Subject, subject_of
from .token_scan import TokenScan, find_token_scan


@dataclass(frozen=True, eq=False)
class Inspection:
    """What was found in a recording of N frames of H x W pixels. A part is worked out when first asked for.

    Ask `health` first. Where it is fatal the rest may mean nothing, and where frames and events are of
    different sizes the rest raises ValueError.
    """

    footage: Footage

    @cached_property
    def subject(self) -> Subject:
        """The events, each with what the light did at its pixel."""
        return subject_of(self.footage)

    @property
    def light(self) -> LightChange:
        """Where and when the light of the frames changed, (N - 1, H, W), and their noise [DN]."""
        return self.subject.light

    @cached_property
    def stamp_step_us(self) -> int:
        """The step of the event times."""
        return basics.stamp_step_us(self.footage.events["t"])

    @cached_property
    def lag(self) -> Lag:
        """How much later than the light of the frames events come [us], and how sure that is."""
        return find_lag(self.subject)

    @cached_property
    def scan_at_rest(self) -> RowScan | None:
        """How events at rest run over the rows after each frame; None where they do not."""
        return find_row_scan(self.subject, self.subject.at_rest)

    @cached_property
    def row_scan(self) -> RowScan | None:
        """The same, else how those in the exposure windows do."""
        return self.scan_at_rest or find_row_scan(
            self.subject, within(self.subject.t_us, self.exposure_windows)
        )

    @cached_property
    def token_scan(self) -> TokenScan | None:
        """How events run over the rows, round after round, whatever frames do; None where they do not."""
        return find_token_scan(self.footage.events, self.footage.height)

    @cached_property
    def bus(self) -> Bus | None:
        """How long the bus takes for a row and for an event; None where it is never busy for long."""
        return find_bus(self.footage.events, self.footage.height, self.footage.width)

    @property
    def row_time_us(self) -> float | None:
        """From one row's readout to the next, negative upwards; None where no readout is seen."""
        return None if self.row_scan is None else self.row_scan.us_per_row

    @cached_property
    def moments(self) -> Moments:
        """Those about a frame's time with more events than others, and with fewer."""
        return find_moments(self.subject, self.scan_at_rest)

    @cached_property
    def bursts(self) -> tuple[FrameBurst, ...]:
        """The moments about a frame's time at which the camera's own readout makes events, in order."""
        return bursts_of(self.subject, self.moments)

    @cached_property
    def exposure_windows(self) -> Windows:
        """(M, 2) [us]: the bursts of all frames and the lulls behind them, of all rows."""
        return windows_of(self.moments, self.light.t_us)

    @cached_property
    def mask(self) -> Mask:
        """The same times, narrower where rows take turns: each row's own."""
        if self.scan_at_rest is None:
            return Mask(self.exposure_windows)
        return row_mask(self.subject, self.scan_at_rest)

    @cached_property
    def hot(self) -> NDArray[np.bool_]:
        """(H, W): pixels whose events neither light nor neighbours explain."""
        outside = ~within(self.subject.t_us, self.exposure_windows)
        return find_hot(self.subject.counts(outside), self.light.change)

    @cached_property
    def silent(self) -> NDArray[np.bool_]:
        """(H, W): pixels without an event, where the light changed and the neighbours told of it."""
        return find_silent(self.subject.all_counts, self.light.change)

    @cached_property
    def health(self) -> Health:
        """The report. What is fatal ends it early."""
        footage = self.footage
        findings = basics.missing(footage)
        if findings:
            return Health(tuple(findings))
        findings = basics.overlap(footage.frame_t_us, footage.events["t"])
        if _fatal(findings):
            return Health(tuple(findings))
        findings += basics.frame_times(footage)
        findings += [basics.stamp_step(self.stamp_step_us), basics.polarities(footage.events["p"])]
        subject = self.subject
        findings += sensor.light(subject)
        if _fatal(findings):
            return Health(tuple(findings))
        findings += [
            sensor.clock(subject, self.lag),
            sensor.event_gaps(subject),
            *sensor.faulty_pixels(subject, self.hot, self.silent),
            sensor.frame_locked(subject, self.bursts, self.exposure_windows),
            sensor.row_readout(subject, self.row_scan, self.token_scan),
        ]
        content = self._content()
        findings += content.findings()
        determinations = () if _fatal(findings) else tuple(content.determinations())
        return Health(tuple(findings), determinations)

    def _content(self) -> Content:
        events, windows, t_us = self.footage.events, self.exposure_windows, self.light.t_us
        clean = ~within(events["t"], windows) & ~self.hot[events["y"], events["x"]]
        masked_share = total_us(windows) / float(t_us[-1] - t_us[0])
        return Content(self.subject, clean, min(masked_share, 1.0))


def inspect(footage: Footage) -> Inspection:
    """What a recording with frames is worth, and what of it to leave out."""
    return Inspection(footage)


def _fatal(findings: list[Finding]) -> bool:
    return any(finding.severity == "fatal" for finding in findings)
