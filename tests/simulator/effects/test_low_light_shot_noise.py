"""Low-light shot noise: ON and OFF events in the dark, at the rates that v2e and IEBCS state."""

import pytest

from voltcam_simulator import Parameters, Simulator

from ..scenes import only, watch_still

SIDE, SECONDS = 50, 10.0


def rates_hz(parameters: Parameters, grey: float) -> tuple[float, float]:
    events = watch_still(Simulator(SIDE, SIDE, parameters, seed=3), grey, SECONDS, 10)
    on = float(events["p"].sum())
    return on / SIDE**2 / SECONDS, (len(events) - on) / SIDE**2 / SECONDS


def test_five_events_a_second_in_the_dark_as_in_v2e() -> None:
    # about 60 000 events of each polarity, whose number spreads by less than 0.5 %
    assert rates_hz(only(low_light_shot_noise={"c": 0.01118}), 0) == pytest.approx((2.5, 2.5), rel=0.02)


def test_on_and_off_rates_measured_at_a_tenth_of_a_lux() -> None:
    thresholds = {"theta_on": 0.86, "theta_off": 1.16}
    parameters = only(low_light_shot_noise={"c": 0.0147}, comparator=thresholds)
    assert rates_hz(parameters, 0) == pytest.approx((5.0, 3.7), rel=0.02)


def test_the_same_with_a_leak_and_equal_thresholds() -> None:
    leak = {"k4_per_us": 1.3e-6}
    parameters = only(low_light_shot_noise={"c": 5 * 8.638e-6**0.5}, junction_leak=leak)
    assert rates_hz(parameters, 0) == pytest.approx((5.0, 3.7), rel=0.02)


@pytest.mark.parametrize("grey", [5, 15])
def test_it_falls_with_the_square_of_brightness(grey: float) -> None:
    parameters = only(low_light_shot_noise={"c": 0.0224, "dark_dn": 5})
    total = sum(rates_hz(parameters, grey))
    assert total == pytest.approx(0.0224**2 * 1e6 / (grey + 5) ** 2, rel=0.03)


def test_it_is_independent_of_the_other_noise() -> None:
    """Variances add, where those of leak and photon noise do not (Eq. 11)."""
    both = only(low_light_shot_noise={"c": 0.01118}, leak_noise={"k6": 5e-6**0.5})
    assert sum(rates_hz(both, 0)) == pytest.approx(10, rel=0.02)
