"""What a recording can determine: which light it shows, how long at rest, what follows for the parameters."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..light.grey import USUAL_DARK_DN
from .finding import Answer, Determination, Finding
from .subject import Subject

_BINS_DN = np.arange(0, 257, 32)


class Content:
    """Counts of what the answers rest on. `clean`: (n,) the events outside masks, of healthy pixels."""

    def __init__(self, subject: Subject, clean: NDArray[np.bool_], masked_share: float) -> None:
        light, events = subject.light, subject.footage.events
        self.level, self.size, self.rate = light.changes()
        seconds = np.diff(light.t_us) / 1e6
        per_pixel_s = np.einsum("t,thw->hw", seconds.astype(np.float32), light.at_rest)
        place = np.clip(np.digitize(light.mean_dn, _BINS_DN) - 1, 0, len(_BINS_DN) - 2)
        bins = len(_BINS_DN) - 1
        self.rest_s = np.bincount(place.ravel(), per_pixel_s.ravel(), bins) * (1 - masked_share)
        self.rest_share = float(light.at_rest.mean())
        self.longest_s = _longest(light.at_rest, seconds)
        rest = clean & subject.at_rest
        here = place[events["y"], events["x"]]
        self.rest_on = np.bincount(here[rest & subject.on], minlength=bins)
        self.rest_off = np.bincount(here[rest & ~subject.on], minlength=bins)
        moving = clean & ~subject.at_rest & (subject.interval >= 0)
        self.moving = [int(np.count_nonzero(moving & (subject.on == on))) for on in (True, False)]
        self.busy_pixels = int(np.count_nonzero(subject.counts(moving) >= 20))
        order = np.argsort(subject.pixel, kind="stable")
        same = np.diff(subject.pixel[order]) == 0
        gap = np.diff(subject.t_us[order])
        at_rest = rest[order]
        self.rest_intervals = int(np.count_nonzero(same & at_rest[1:] & at_rest[:-1]))
        alike = same & (np.diff(subject.on[order].astype(np.int8)) == 0)
        short = gap[alike & (gap < 5000)]
        self.short_intervals = int(short.size)
        self.shortest_us = float(np.quantile(short, 0.01)) if short.size >= 100 else None
        self.fps = 1e6 / subject.period_us

    def findings(self) -> list[Finding]:
        """What of the light the recording shows."""
        numbers: dict[str, Any] = {
            "rest_share": self.rest_share,
            "longest_rest_s": self.longest_s,
            "rest_pixel_s": self.rest_s.round(1).tolist(),
            "bins_dn": _BINS_DN.tolist(),
        }
        words = f"{self.rest_share:.0%} of the pixels' time is at rest, half of the pixels for "
        words += f"{self.longest_s:.1f} s or more at a stretch"
        enough = self.rest_s.sum() > 1000
        rest = Finding("light at rest", "good" if enough else "limits", words, numbers)
        if self.size.size < 100:
            return [rest, Finding("light in motion", "limits", "the light hardly changes", {})]
        low, high = np.quantile(self.level, [0.05, 0.95]).tolist()
        slow, fast = np.quantile(self.rate, [0.05, 0.95]).tolist()
        step = float(np.quantile(self.size, 0.75))
        numbers = {
            "level_dn": [low, high],
            "rate_per_s": [slow, fast],
            "step_per_frame": step,
            "fps": self.fps,
        }
        words = f"grey levels {low:.0f} to {high:.0f}, ln L changes by {slow:.2g} to {fast:.2g} per second"
        if step > 0.5:
            words += f", by {step:.1f} from frame to frame: at {self.fps:.0f} fps the path between is a guess"
        return [rest, Finding("light in motion", "limits" if step > 0.5 else "good", words, numbers)]

    def determinations(self) -> list[Determination]:
        """What can be fitted."""
        return [
            self._gain(),
            self._thresholds(),
            self._leak(),
            self._noise(),
            self._refractory(),
            self._mismatch(),
            Determination(
                ("temperature_c", "activation_energy_ev"),
                "no",
                "one recording has one temperature: record at two or more, 10 degrees apart",
                {},
            ),
        ]

    def _gain(self) -> Determination:
        names = ("k1", "k2_dn")
        if min(self.moving) < 500 or self.size.size < 500:
            return Determination(names, "no", "too few events of moving light", {"events": sum(self.moving)})
        low, high = np.quantile(self.level, [0.1, 0.9]).tolist()
        ratio = (high + USUAL_DARK_DN) / (low + USUAL_DARK_DN)
        numbers = {"level_dn": [low, high], "ratio": ratio, "events": sum(self.moving)}
        if ratio >= 3:
            return Determination(names, "yes", f"moving light from {low:.0f} to {high:.0f} DN", numbers)
        words = f"moving light only from {low:.0f} to {high:.0f} DN: k1/(L+k2) there, not k1 and k2 apart"
        return Determination(names, "in part", words, numbers)

    def _thresholds(self) -> Determination:
        numbers = {"on": self.moving[0], "off": self.moving[1]}
        answer: Answer = "yes" if min(self.moving) >= 500 else "no"
        words = f"{self.moving[0]} ON and {self.moving[1]} OFF events of moving light"
        return Determination(("theta_on", "theta_off"), answer, words, numbers)

    def _leak(self) -> Determination:
        names = ("k4_per_us", "k5_per_dn_us")
        held = self.rest_s > max(20.0, 0.03 * float(self.rest_s.sum()))
        total_s, count = float(self.rest_s.sum()), int(self.rest_on.sum())
        edges = [(int(_BINS_DN[i]), int(_BINS_DN[i + 1])) for i in np.flatnonzero(held)]
        numbers = {"on_at_rest": count, "rest_pixel_s": total_s, "levels_dn": edges}
        if total_s < 100:
            return Determination(names, "no", "hardly any pixel is at rest for long", numbers)
        rate = (count + 3 if count < 20 else count) / total_s
        if count < 100:
            words = (
                f"{count} ON events in {total_s:.0f} pixel seconds at rest: only about {rate:.2g}/s at most"
            )
            return Determination(names, "in part", words, numbers)
        if len(edges) < 3:
            words = f"{count} ON events at rest, but at {len(edges)} brightnesses: their sum, not each"
            return Determination(names, "in part", words, numbers)
        words = f"{count} ON events at rest ({rate:.2g} per s and pixel), {edges[0][0]} to {edges[-1][1]} DN"
        return Determination(names, "yes", words, numbers)

    def _noise(self) -> Determination:
        names, count = ("k3", "k6"), self.rest_intervals
        levels = int(np.count_nonzero(self.rest_on + self.rest_off >= 50))
        numbers = {"intervals_at_rest": count, "levels": levels}
        words = f"{count} intervals between events of one pixel at rest, at {levels} brightnesses"
        if count >= 500 and levels >= 2:
            return Determination(names, "yes", words, numbers)
        if count >= 100:
            return Determination(names, "in part", f"{words}: one of them, or their sum", numbers)
        return Determination(names, "no", f"{words}: hold an image still for a minute", numbers)

    def _refractory(self) -> Determination:
        numbers = {"short_intervals": self.short_intervals, "shortest_us": self.shortest_us}
        if self.short_intervals >= 300 and self.shortest_us is not None:
            words = (
                f"{self.short_intervals} intervals below 5 ms, a hundredth below {self.shortest_us:.0f} us"
            )
            return Determination(("period_us",), "yes", words, numbers)
        words = f"{self.short_intervals} intervals below 5 ms: only that it is shorter than most; move faster"
        return Determination(("period_us",), "no", words, numbers)

    def _mismatch(self) -> Determination:
        numbers = {"pixels": self.busy_pixels}
        answer: Answer = "yes" if self.busy_pixels >= 500 else "no"
        words = f"{self.busy_pixels} pixels with 20 events of moving light or more"
        return Determination(("threshold_mismatch",), answer, words, numbers)


def _longest(at_rest: NDArray[np.bool_], seconds: NDArray[np.float64]) -> float:
    """The median over pixels of their longest stretch at rest."""
    run = np.zeros(at_rest.shape[1:], np.float32)
    longest = np.zeros_like(run)
    for plane, length in zip(at_rest, seconds, strict=True):
        run = np.where(plane, run + np.float32(length), 0)
        np.maximum(longest, run, out=longest)
    return float(np.median(longest))
