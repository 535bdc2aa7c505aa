"""Each hidden effect of the tests' own camera does what it says: one observable each, in closed form if there
is one. Each takes the effect as drawn, at level strong; tolerances are at least 4 standard errors."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from tests.generator import LEVELS, LISTED, UNLISTED, Effect, Recorded, draw_effect, record, still_scene
from tests.generator.probes import FAST, JUNCTION, LEAKY, QUIET, counts, intervals_us, moving, rayleigh, seen


def refractory_period(effect: Effect) -> None:
    """A leak of 5000/s after each: 200 us more."""
    assert intervals_us(seen(effect, FAST, seconds=1.2)) == pytest.approx(6200, abs=2)


def photoreceptor_bandwidth(effect: Effect) -> None:
    """A lamp at 20 Hz before two poles, of 30 and 240 Hz at 128 DN: .83 of the swing, less in the dark."""
    lamp = Effect("flicker", "", {"depth": 0.1, "frequency_hz": 20, "phase": 0})
    many = replace(QUIET, theta_on=0.02, theta_off=0.02)
    for dn, cutoff in ((128.0, 30.0), (20.0, 30 * (0.1 + 0.9 * 20 / 255) / (0.1 + 0.9 * 128 / 255))):
        scene = still_scene(np.full((4, 4), dn))
        full, low = (len(record(scene, many, effects, 2).events) for effects in ([lamp], [lamp, effect]))
        expected = 1 / np.sqrt((1 + (20 / cutoff) ** 2) * (1 + (20 / 240) ** 2))
        assert low / full == pytest.approx(expected, abs=0.05)


def comparator(effect: Effect) -> None:
    found = moving(effect)
    assert counts(found, False).sum() / counts(found, True).sum() == pytest.approx(
        effect.parameters["ratio"], rel=0.08
    )


def flicker(effect: Effect) -> None:
    assert rayleigh(seen(effect), effect.parameters["frequency_hz"]) > 0.2
    assert rayleigh(seen(None), effect.parameters["frequency_hz"]) < 0.05


def aps_coupling(effect: Effect) -> None:
    """+kick at exposure start: most leak events come just then; all rows at once."""
    found = seen(effect)
    since = (found.events["t"] + effect.parameters["exposure_us"] / 2) % 5000
    struck = found.events["p"] & ((since < 1) | (since > 4999))
    assert struck.sum() / found.events["p"].sum() > 0.5
    noisy = seen(effect, replace(QUIET, k6=5e-4)).events
    off = noisy[~noisy["p"]]
    after = (off["t"] - effect.parameters["exposure_us"] / 2 - 35.25 * off["y"]) % 5000
    assert np.mean((after < 2) | (after > 4998)) > 0.5


def latency(effect: Effect) -> None:
    """Two sparse recordings of the same raw events, pixel by pixel in the same order."""
    slow = replace(LEAKY, k5=2e-8)
    before, after = seen(None, slow), seen(effect, slow)
    whole = counts(before) == counts(after)  # none pushed over the end
    assert whole.mean() > 0.95
    times = []
    for each in (before, after):
        kept = each.events[whole[each.events["y"], each.events["x"]]]
        times.append(kept["t"][np.lexsort((kept["t"], kept["x"], kept["y"]))])
    late = times[1] - times[0]
    assert late.mean() == pytest.approx(effect.parameters["delay_us"], abs=4 * 2000 / np.sqrt(len(late)))
    assert late.std() == pytest.approx(2000, rel=0.05)


def readout(effect: Effect) -> None:
    found = moving(effect, replace(QUIET, k1=20.0))
    per_10ms = np.bincount(found.events["t"] // 10_000)
    free = moving(None, replace(QUIET, k1=20.0))
    assert np.bincount(free.events["t"] // 10_000).max() > 400
    assert 150 < per_10ms.max() <= 10_000 / 60 + 24
    same = np.flatnonzero(np.diff(found.events["t"]) == 0)
    assert same.size > 100
    assert np.array_equal(found.events["y"][same], found.events["y"][same + 1])


def hot_pixels(effect: Effect) -> None:
    found = seen(effect, QUIET)
    x, y = found.truth["patterns"]["hot_pixels"].T
    assert len(x) == round(0.015 * 384)
    assert counts(found)[y, x].sum() == len(found.events)
    assert len(found.events) == pytest.approx(3 * found.truth["patterns"]["hot_hz"].sum(), rel=0.25)
    assert found.events["p"].mean() > 0.88


def dead_pixels(effect: Effect) -> None:
    found = seen(effect)
    x, y = found.truth["patterns"]["dead_pixels"].T
    assert np.all(counts(found)[y, x] == 0)
    assert np.count_nonzero(counts(found) == 0) == round(0.03 * 384)


def low_light_shot_noise(effect: Effect) -> None:
    rate = 1e6 * (0.012 / (10 + effect.parameters["dark_dn"])) ** 2
    found = seen(effect, QUIET, dn=10, seconds=11)
    late = found.events["t"] > 3_000_000
    assert late.sum() == pytest.approx(8 * 384 * rate, rel=0.1)
    assert found.events["p"][late].mean() == pytest.approx(0.5, abs=0.06)


def threshold_mismatch(effect: Effect) -> None:
    found = seen(effect)
    factor = found.truth["patterns"]["theta_on_factor"]
    spread = np.std(np.log(factor) if effect.parameters["log_normal"] else factor)
    assert spread == pytest.approx(0.2, rel=0.15)
    assert np.corrcoef(counts(found).ravel(), 1 / factor.ravel())[0, 1] > 0.98


def reset_noise(effect: Effect) -> None:
    """Start N(0, s) instead of 0: the interval's spread grows to sqrt(IG^2 + (s/mu)^2)."""
    noiseless = replace(LEAKY, k3=1e-6)
    assert intervals_us(seen(effect, noiseless)).std() == pytest.approx(0.28e6 / 12.8, rel=0.05)
    assert intervals_us(seen(None, noiseless)).std() < 500


def leak_mismatch(effect: Effect) -> None:
    found = seen(effect, JUNCTION, seconds=11)
    factor = found.truth["patterns"]["leak_factor"]
    assert np.std(np.log(factor)) == pytest.approx(1.0, rel=0.2)
    assert counts(found) == pytest.approx(110 * factor, abs=1.5)


def temperature_drift(effect: Effect) -> None:
    found = seen(effect, JUNCTION)
    early, late = (found.events["t"] < 750_000).sum(), (found.events["t"] > 2_250_000).sum()
    assert late / early == pytest.approx(5**0.75, rel=0.05)


def usb_overflow(effect: Effect) -> None:
    free, found = moving(None), moving(effect)
    assert 1 - len(found.events) / len(free.events) == pytest.approx(0.2, abs=0.07)
    busy = np.bincount(free.events["t"] // 2000, minlength=1000) > 10
    assert np.count_nonzero(busy & (np.bincount(found.events["t"] // 2000, minlength=1000) == 0)) > 3


def crosstalk(effect: Effect) -> None:
    """Each event gives delta to four neighbours: away from the rim leak rates grow by 1/(1 - 4 delta)."""
    few = Effect("crosstalk", "", {"kick": 0.05})
    inner = slice(4, -4)
    gain = counts(seen(few))[inner, inner].sum() / counts(seen(None))[inner, inner].sum()
    assert gain == pytest.approx(1 / (1 - 0.2), rel=0.03)
    assert len(seen(effect).events) > 1.4 * len(seen(None).events)


def noise_pairs(effect: Effect) -> None:
    for dn, least in ((10, 5.0), (230, 0)):
        assert len(seen(effect, QUIET, dn=dn).events) / 384 / 3 >= least
    found = seen(effect, QUIET, dn=10)
    assert np.mean(intervals_us(found) < 50_000) > 0.3
    assert 0.4 < found.events["p"].mean() < 0.6


def timestamp_quantum(effect: Effect) -> None:
    assert np.all(seen(effect).events["t"] % 1000 == 0)


def clock_offset(effect: Effect) -> None:
    found = seen(effect)
    assert abs(found.frame_t_us[0]) == 4000
    assert np.array_equal(found.events, seen(None).events)


def _rate(found: Recorded) -> float:
    """Signed events per pixel and second, the first second aside."""
    e = found.events[found.events["t"] >= 1_000_000]
    return float((2.0 * e["p"] - 1).sum() / (found.width * found.height * (found.truth["seconds"] - 1)))


def dark_drift(effect: Effect) -> None:
    for dn in (20, 60):
        p = effect.parameters
        expected = p["per_s"] * ((20 + p["l0_dn"]) / (dn + p["l0_dn"])) ** p["power"]
        noise = replace(QUIET, k3=1e-4)
        assert _rate(seen(effect, noise, dn=dn, seconds=11)) == pytest.approx(expected, abs=0.06)


def root_drift(effect: Effect) -> None:
    for dn in (32, 128):
        found = seen(effect, replace(QUIET, k3=1e-4), dn=dn, seconds=11)
        assert _rate(found) == pytest.approx(-2 * np.sqrt(dn / 128), abs=0.06)


def column_drift(effect: Effect) -> None:
    found = seen(effect, seconds=11)
    net = (counts(found, True) - counts(found, False).astype(float)).mean(0) / 11
    expected = 12.8 + effect.parameters["per_s"] * np.linspace(-1, 1, 24)
    assert net == pytest.approx(expected, abs=0.15)


def rebound(effect: Effect) -> None:
    """-A returns within the interval: 1 + A to climb."""
    quick = Effect("rebound", "", {"voltage": 0.4, "tau_us": 5e3})
    assert 1e6 / intervals_us(seen(quick)).mean() == pytest.approx(12.8 / 1.4, rel=0.02)
    assert _rate(seen(effect)) < 0.95 * _rate(seen(None))


def tiring_threshold(effect: Effect) -> None:
    """Steady state of a leak of 12.8/s: T mu = 1 + r/(exp(T/tau) - 1)."""
    p = effect.parameters
    gap = np.linspace(0.05, 0.2, 200_001)
    expected = gap[np.argmin(np.abs(gap * 12.8 - 1 - p["rise"] / np.expm1(gap * 1e6 / p["tau_us"])))]
    assert intervals_us(seen(effect)).mean() * 1e-6 == pytest.approx(expected, rel=0.02)


def threshold_ripple(effect: Effect) -> None:
    assert rayleigh(seen(effect), effect.parameters["frequency_hz"]) > 0.15
    assert rayleigh(seen(None), effect.parameters["frequency_hz"]) < 0.06


def row_shadow(effect: Effect) -> None:
    base = replace(QUIET, k6=3e-3)
    free, found = seen(None, base, seconds=2), seen(effect, base, seconds=2)
    assert counts(found, True).sum() == counts(free, True).sum()
    rate = counts(free, True).sum() / 2 / 16  # ON events per row and second
    expected = np.exp(-2 * rate * effect.parameters["shadow_us"] * 1e-6)
    assert counts(found, False).sum() / counts(free, False).sum() == pytest.approx(expected, rel=0.15)


def after_events(effect: Effect) -> None:
    assert len(seen(effect).events) / len(seen(None).events) == pytest.approx(1.25, abs=0.02)
    assert np.mean(intervals_us(seen(effect)) < 5_000) == pytest.approx(0.2, abs=0.02)


def dim_refractory(effect: Effect) -> None:
    for dn in (10, 60):
        gaps = intervals_us(seen(effect, FAST, dn=dn, seconds=1.2))
        assert gaps == pytest.approx(9000 * 20 / dn + 200, abs=2)


def striped_thresholds(effect: Effect) -> None:
    """A leak of 12.8 thresholds/s for 8 s: 102 events where they are 1, to one event."""
    p = effect.parameters
    found = counts(seen(effect, replace(LEAKY, k3=1e-6), seconds=8))
    y, x = np.indices(found.shape)
    band = (y if p["of_rows"] else x) // p["band_px"] % 2
    for which, theta in ((0, 0.7), (1, 1.3)):
        assert found[band == which] == pytest.approx(8 * 12.8 / theta, abs=1.5)


def slew_limit(effect: Effect) -> None:
    free, found = moving(None), moving(effect)
    assert len(found.events) < 0.75 * len(free.events)


OBSERVED: dict[str, Callable[[Effect], None]] = {name: globals()[name] for name in (*LISTED, *UNLISTED)}


@pytest.mark.parametrize("name", OBSERVED)
def test_effect_does_what_it_says(name: str) -> None:
    effect = draw_effect(np.random.default_rng(6), name, "strong")
    assert effect.listed == (name in LISTED)
    OBSERVED[name](effect)


@pytest.mark.parametrize("name", OBSERVED)
def test_levels_differ(name: str) -> None:
    drawn = [draw_effect(np.random.default_rng(6), name, level).parameters for level in LEVELS]
    assert drawn[0] != drawn[1] != drawn[2]
