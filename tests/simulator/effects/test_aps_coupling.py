"""APS coupling: events in the phase of the frames, and in scans that move with the row."""

import numpy as np
import pytest
from scipy import stats

from voltcam_simulator import Parameters, Simulator

from ..scenes import Events, cuts, intervals_us, only, still, watch_at, watch_still

WIDTH, HEIGHT = 30, 50
PERIOD_US, EXPOSURE_US, ROW_US = 10_000, 500, 35.25
FRAME = {"frame_period_us": PERIOD_US, "exposure_us": EXPOSURE_US, "row_us": ROW_US, "offset_us": 1234}


def leaky(leak: float = 2e-6, **kicks: float) -> Parameters:
    """A leak of 0.02 thresholds in each frame, without any noise: pixels are clocks."""
    return only(junction_leak={"k4_per_us": leak}, aps_coupling={**FRAME, **kicks})


def phase_us(events: Events) -> np.ndarray:
    return (events["t"] - 1234) % PERIOD_US


def watch(parameters: Parameters, times_us: np.ndarray) -> Events:
    return watch_at(parameters, times_us, WIDTH, HEIGHT)


def test_without_kicks_leak_events_have_any_phase() -> None:
    events = watch(only(junction_leak={"k4_per_us": 2e-6}), cuts(50))
    assert stats.kstest(phase_us(events[: WIDTH * HEIGHT]), stats.uniform(0, PERIOD_US).cdf).pvalue > 1e-4


def test_leak_events_lock_to_the_two_scans() -> None:
    """A pixel that gains 0.02 in a frame is caught by a kick of 0.05 on its way, at its row's turn."""
    for kick, begin_us in (("reset_kick", 0), ("readout_kick", HEIGHT * ROW_US + EXPOSURE_US)):
        events = watch(leaky(**{kick: 0.05}), cuts(50))
        events = events[events["t"] > 20_000]  # some stood within 0.02 of the threshold before the first kick
        assert len(events) > 3 * WIDTH * HEIGHT
        late_us = phase_us(events) - np.floor(events["y"] * ROW_US + begin_us)
        assert late_us.min() >= 0
        assert late_us.max() <= ROW_US + 1  # the leak goes on while the line is up
        assert (late_us == 0).mean() > 0.99


def test_a_row_is_caught_for_as_long_as_its_line_is_up() -> None:
    """In 1 of 10 ms a leak brings a tenth of what it brings in a frame: so many do not fire at once."""
    events = watch(leaky(readout_kick=0.05, line_us=1000), cuts(50))
    events = events[events["t"] > 20_000]
    late_us = phase_us(events) - np.floor(events["y"] * ROW_US + HEIGHT * ROW_US + EXPOSURE_US)
    assert late_us.min() >= 0
    assert 900 < late_us.max() <= 1001
    assert (late_us > 0).mean() == pytest.approx(0.1, abs=0.02)


def test_exposure_catches_on_where_it_begins_and_sets_off_free_where_it_ends() -> None:
    """While a scene brightens ON events come in the exposure, 4 of 10 ms, or as it begins: all that are due
    before the next. While it darkens OFF does not come in the exposure, but as it ends."""
    frame = {**FRAME, "exposure_us": 4000, "exposure_kick": 0.3}
    begins = int(HEIGHT * ROW_US)
    # reset noise spreads the instants at which events are due over more than a frame
    parameters = only(contrast_response={"k1": 20}, reset_noise={"sigma": 0.15}, aps_coupling=frame)
    brightening = 30 * (220 / 30) ** np.linspace(0, 1, 300) - 20  # 39.8 thresholds in 3 s, 0.13 in a frame
    for light in (brightening, brightening[::-1]):
        simulator = Simulator(WIDTH, HEIGHT, parameters, seed=1)
        frames = [simulator.advance(still(g, WIDTH, HEIGHT), 9999 * k) for k, g in enumerate(light)]
        events = np.concatenate(frames)
        events = events[events["t"] > 50_000]  # some stood within 0.3 of the ON threshold at the start
        phase = phase_us(events)
        if light[0] < light[-1]:
            assert events["p"].all()
            assert ((phase >= begins) & (phase <= begins + 4000)).all()
            assert (phase == begins).mean() == pytest.approx(0.6, abs=0.02)
        else:
            assert not events["p"].any()
            assert not ((phase > begins) & (phase < begins + 4000)).any()
            assert (phase == begins + 4000).mean() == pytest.approx(0.4, abs=0.02)


@pytest.mark.parametrize("pieces", [2, 7, 33, 500, 20_000])
def test_every_kick_comes_once_however_time_is_cut(pieces: int) -> None:
    """From one interval with 200 frames to intervals of a few rows' time. Nothing is random: events are the
    same but for the rounding of voltages at each cut, which moves few of them to the kick before or behind.
    One kick too many or too few would shift all later events of a row by two frames or more."""
    parameters = leaky(reset_kick=0.06, readout_kick=0.09, exposure_kick=0.05)
    whole, cut = (watch(parameters, cuts(n)) for n in (1, pieces))
    times = []
    for events in (whole, cut):
        events = events[np.lexsort((events["t"], events["x"], events["y"]))]
        pixel = events["y"].astype(int) * WIDTH + events["x"]
        start = np.searchsorted(pixel, np.arange(WIDTH * HEIGHT))
        times.append(events["t"][start[:, None] + np.arange(3)])
    shift_us = np.abs(times[1] - times[0])
    assert shift_us.max() <= PERIOD_US
    assert (shift_us > 2).mean() < 0.02


def test_a_kick_on_the_very_boundary_of_two_intervals_comes_once() -> None:
    """Rows of 40 us and intervals that end with each; a kick of half a threshold sets off an eighth of
    the pixels, whose voltages have the tent, in both bands of rows that a sensor so wide is worked in."""
    on_the_grid = {"row_us": 40, "offset_us": 0, "readout_kick": 0.5}
    parameters = only(aps_coupling={**FRAME, **on_the_grid})
    simulator = Simulator(400, HEIGHT, parameters, seed=5)
    events = np.concatenate([simulator.advance(still(9, 400, HEIGHT), t) for t in range(0, 10_000, 20)])
    assert stats.binomtest(len(events), 400 * HEIGHT, 0.125).pvalue > 1e-4
    assert (events["t"] == events["y"].astype(int) * 40 + HEIGHT * 40 + EXPOSURE_US).all()


@pytest.mark.parametrize(("dead_us", "again"), [(0, False), (600, True)])
def test_a_kick_that_is_taken_back_in_the_dead_time_is_memorised(dead_us: float, again: bool) -> None:
    """The first exposure sets off a pixel, which stands half a threshold below 0 when it ends, unless held.
    Then light brings 0.9 and the next exposure 0.5."""
    parameters = only(
        contrast_response={"k1": 1}, refractory_period={"period_us": dead_us},
        aps_coupling={**FRAME, "offset_us": 0, "exposure_kick": 0.5},
    )  # fmt: skip
    simulator = Simulator(WIDTH, HEIGHT, parameters, seed=1)
    simulator.advance(still(100, WIDTH, HEIGHT), 0)
    first = simulator.advance(still(100, WIDTH, HEIGHT), 5000)
    assert (first["t"] == int(HEIGHT * ROW_US)).all()
    simulator.advance(still(120 * np.exp(0.9) - 20, WIDTH, HEIGHT), 9000)
    second = simulator.advance(still(120 * np.exp(0.9) - 20, WIDTH, HEIGHT), 15_000)
    fired = np.isin(first["y"] * WIDTH + first["x"], second["y"] * WIDTH + second["x"])
    assert len(first) > 100
    assert fired.all() if again else not fired.any()


def test_the_time_line_may_start_anywhere() -> None:
    parameters, t0_us = leaky(readout_kick=0.05), 1_763_000_000 * 1_000_000
    early, late = (watch_still(Simulator(WIDTH, HEIGHT, parameters, seed=1), 9, 1, 30, t) for t in (0, t0_us))
    late["t"] -= t0_us
    assert early.tobytes() == late.tobytes()


def test_noise_and_a_dead_time_do_not_see_the_cuts() -> None:
    """Everything a path can meet at once: the same statistics from 1 and from 33 intervals."""
    parameters = only(
        contrast_response={"k1": 3}, leak_noise={"k6": 4e-3}, reset_noise={"sigma": 0.1},
        refractory_period={"period_us": 3000},
        aps_coupling={**FRAME, "reset_kick": 0.2, "readout_kick": 0.3, "exposure_kick": -0.2},
    )  # fmt: skip

    def run(pieces: int, seed: int) -> Events:
        simulator = Simulator(60, HEIGHT, parameters, seed=seed)
        frames = [np.full((HEIGHT, 60), 50 * 5 ** (i / pieces) - 20) for i in range(pieces + 1)]
        return np.concatenate([simulator.advance(f, 500_000 * i // pieces) for i, f in enumerate(frames)])

    whole, cut = run(1, 1), run(33, 2)
    for polarity in (True, False):
        a, b = (events[events["p"] == polarity] for events in (whole, cut))
        counts = [np.bincount(e["y"].astype(int) * 60 + e["x"], minlength=60 * HEIGHT) for e in (a, b)]
        assert len(a) > 1000
        assert stats.ttest_ind(*counts).pvalue > 1e-4
        assert stats.ks_2samp(a["t"], b["t"], method="asymp").pvalue > 1e-4
        assert stats.ks_2samp(phase_us(a), phase_us(b), method="asymp").pvalue > 1e-4
    between = [intervals_us(events, 60) for events in (whole, cut)]
    assert min(b.min() for b in between) >= 3000
    assert stats.ks_2samp(*between, method="asymp").pvalue > 1e-4
