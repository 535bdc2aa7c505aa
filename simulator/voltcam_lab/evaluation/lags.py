"""How far behind the frames events are, real and simulated, by the measure of the health report."""

from collections.abc import Mapping
from dataclasses import replace

from voltcam_simulator.effect import Events

from ..distances import Region
from ..health.lag import Lag, find_lag, threshold_of
from ..health.subject import subject_of
from ..recordings import Footage

REAL = "real"


def lags_of(footage: Footage, streams: Mapping[str, Events], region: Region) -> dict[str, Lag]:
    """Of each stream {name: events} at a region's pixels, in the intervals between frames that lie in it.

    What is hidden of these counts, too: windows about exposures. The threshold of the memorised level is that
    of all the recording's events. None for a stream whose events do not follow the frames.
    """
    stretch = region.stretch_of(footage.frame_t_us)
    counted = (stretch[:-1] >= 0) & (stretch[:-1] == stretch[1:])
    threshold = threshold_of(subject_of(footage))
    found = {}
    for name, events in streams.items():
        there = events[region.pixels[events["y"], events["x"]]]
        if len(there):
            found[name] = find_lag(subject_of(replace(footage, events=there)), threshold, counted)
    return {name: lag for name, lag in found.items() if lag.is_sure}


def told(lags: Mapping[str, Lag]) -> str:
    """As a table in Markdown; "" where nothing is known."""
    if not lags:
        return ""
    values = [f"{lag.lag_us / 1000:.1f} ± {lag.uncertainty_us / 1000:.1f}" for lag in lags.values()]
    return f"| lag [ms] | {' | '.join(lags)} |\n{'|---' * (len(lags) + 1)}|\n| | {' | '.join(values)} |"
