"""The simulator as a user has it: frames in, events out."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator import EVENT, Law, Limits, Parameters, Simulator

from .scenes import Events, intervals_us, only, still, watch_still

P_LIMIT = 1e-4


@pytest.mark.parametrize("fps", [30, 240, 1000])
def test_leak_intervals_are_brownian_at_any_frame_rate(fps: int) -> None:
    simulator = Simulator(48, 40, Parameters.of("paper"), seed=fps)
    between = intervals_us(watch_still(simulator, 128, 8, fps), 48)
    mu = 1e-7 + 5e-9 * 128
    sigma = 1e-4 * math.sqrt(128) / 148 + 1e-5
    law = stats.invgauss(mu=sigma**2 / mu, scale=1 / sigma**2)  # mean 1/mu, shape (1/sigma)^2
    assert law.std() == pytest.approx(27_700, rel=0.01)  # the figure of the design page
    # the window of 8 s favours short intervals, here by less than .1 % of the mean
    assert stats.kstest(between, law.cdf).pvalue > P_LIMIT


@pytest.mark.parametrize(("fps", "spread_ms"), [(30, 8.7), (240, 4.1), (1000, 1.7)])
def test_the_paper_law_averages_its_noise_away(fps: int, spread_ms: float) -> None:
    simulator = Simulator(40, 30, Parameters.of("paper"), law="paper", seed=1)
    between = intervals_us(watch_still(simulator, 128, 5.6, fps), 40)
    assert between.mean() == pytest.approx(1.351e6, rel=0.005)
    assert between.std() / 1e3 == pytest.approx(spread_ms, rel=0.2)


def test_the_leak_rate_is_the_long_run_one_from_the_start() -> None:
    simulator = Simulator(200, 200, Parameters.of("paper"), seed=4)
    events = watch_still(simulator, 128, 0.5, 30)
    expected = 7.4e-7 * 0.5e6 * 200 * 200
    # a pixel fires once at most, so the count is binomial: 5 standard deviations, chance 6e-7
    assert abs(len(events) - expected) < 5 * math.sqrt(expected)
    assert events["p"].all()
    halves = np.histogram(events["t"], [0, 250_000, 500_000])[0]
    assert abs(halves[0] - halves[1]) < 5 * math.sqrt(expected)


def log_ramp(start: float, end: float, cuts: int, shape: tuple[int, int]) -> list[NDArray[np.float64]]:
    """Frames whose ln(F + k2) is a straight line in time."""
    return [
        np.full(shape, (start + 20) * ((end + 20) / (start + 20)) ** (i / cuts) - 20) for i in range(cuts + 1)
    ]


@pytest.mark.parametrize("noise_in_bands", [0.01, 0.5, 2.0])
@pytest.mark.parametrize("cuts", [8, 33])
def test_a_ramp_has_the_same_statistics_however_it_is_cut(cuts: int, noise_in_bands: float) -> None:
    """The drift is a straight line and the noise constant, so the exact law must not see the frames."""
    parameters = only(contrast_response={"k1": 2.0}, leak_noise={"k6": 2 * noise_in_bands / 1000})

    def run(pieces: int, seed: int) -> Events:
        simulator = Simulator(60, 60, parameters, seed=seed)
        frames = log_ramp(30, 220, pieces, (60, 60))
        times = [round(1e6 * i / pieces) for i in range(pieces + 1)]
        return np.concatenate([simulator.advance(f, t) for f, t in zip(frames, times, strict=True)])

    whole, cut = run(1, 1), run(cuts, 2)
    for polarity in (True, False):
        a, b = whole[whole["p"] == polarity], cut[cut["p"] == polarity]
        if len(a) + len(b) < 50:
            continue
        per_pixel = [np.bincount(e["y"].astype(int) * 60 + e["x"], minlength=3600) for e in (a, b)]
        spread = math.sqrt(sum(counts.var() / counts.size for counts in per_pixel))
        assert abs(per_pixel[0].mean() - per_pixel[1].mean()) <= 4 * spread  # 6e-5 for a correct sampler
        assert stats.ks_2samp(a["t"], b["t"]).pvalue > P_LIMIT
    gaps = [intervals_us(e, 60) for e in (whole, cut)]
    assert stats.ks_2samp(*gaps).pvalue > P_LIMIT


def test_zero_to_white_is_the_logarithm_not_its_linearisation() -> None:
    counts: dict[Law, int] = {}
    for law in ("exact", "paper"):
        parameters = only(contrast_response={"k1": 5.265, "k2_dn": 20})
        simulator = Simulator(1, 1, parameters, law=law, seed=0)
        simulator.jump(still(0, 1, 1), 0)
        simulator.advance(still(0, 1, 1), 1000)
        events = simulator.advance(still(255, 1, 1), 2000)
        assert events["p"].all()
        counts[law] = len(events)
    # 2.62 k1 = 13.8 thresholds from a start in (-1, 1); linearised 1.73 k1 = 9.1 from 0
    assert counts["exact"] in (13, 14)
    assert counts["paper"] == 9


def test_darkening_gives_off_events_and_halving_thresholds_doubles_them() -> None:
    totals = []
    for theta in (1.0, 0.5):
        thresholds = {"theta_on": theta, "theta_off": theta}
        simulator = Simulator(32, 32, only(contrast_response={"k1": 5}, comparator=thresholds), seed=7)
        simulator.advance(still(200, 32, 32), 0)
        events = simulator.advance(still(10, 32, 32), 10_000)
        assert not events["p"].any()
        totals.append(len(events) / 1024)
    # the start is a tent, its remainder modulo a threshold uniform: half an event is lost to rounding down
    change = 5 * math.log(220 / 30)
    spread = math.sqrt(1 / 6 / 1024)
    assert totals[0] == pytest.approx(change - 0.5, abs=5 * spread)
    assert totals[1] == pytest.approx(2 * change - 0.5, abs=5 * spread)


@pytest.mark.parametrize("t0_us", [0, 1_763_000_000_000_000, -(10**15)])
def test_the_start_of_the_time_line_does_not_matter(t0_us: int) -> None:
    def run(start: int) -> Events:
        simulator = Simulator(20, 20, Parameters.of("paper"), seed=9)
        return watch_still(simulator, 90, 4, 30, start)

    events, reference = run(t0_us), run(0)
    assert len(events) > 0
    assert (events["t"] - t0_us).tolist() == reference["t"].tolist()


def test_ten_hours_of_sparse_frames() -> None:
    """A frame each five seconds for ten hours: each hour has as many leak events as it should."""
    simulator = Simulator(8, 8, Parameters.of("paper"), seed=11)
    events = watch_still(simulator, 128, 36_000, 0.2)
    rate = 7.4e-7
    expected = rate * 3.6e10 * 64
    # intervals spread by 2 % only, so the count is that of a renewal process: sd < sqrt(64) events
    assert len(events) == pytest.approx(expected, abs=64)
    hours = np.histogram(events["t"], np.arange(0, 11) * 3_600_000_000)[0]
    np.testing.assert_allclose(hours, expected / 10, atol=64)
    assert events["t"].max() > 35_990_000_000


@given(st.data())
@settings(max_examples=30, deadline=None)
def test_events_are_sorted_inside_their_interval_and_on_the_sensor(data: st.DataObject) -> None:
    width, height = data.draw(st.integers(1, 40)), data.draw(st.integers(1, 40))
    law = data.draw(st.sampled_from(["exact", "paper"]))
    parameters = Parameters().changed(
        {"comparator": {"theta_on": data.draw(st.sampled_from([0.05, 1, 5]))}, "leak_noise": {"k6": 1e-4}}
    )
    simulator = Simulator(width, height, parameters, law=law, seed=data.draw(st.integers(0, 2**63 - 1)))
    rng = np.random.default_rng(1)
    t_us = data.draw(st.integers(-(2**50), 2**50))
    simulator.advance(rng.integers(0, 256, (height, width), np.uint8), t_us)
    for _ in range(3):
        span = data.draw(st.integers(1, 10**6))
        events = simulator.advance(rng.integers(0, 256, (height, width), np.uint8), t_us + span)
        assert events.dtype == EVENT
        if len(events):
            assert (np.diff(events["t"]) >= 0).all()
            assert events["t"][0] >= t_us
            assert events["t"][-1] <= t_us + span
            assert events["x"].max() < width
            assert events["y"].max() < height
        t_us += span


def test_thousands_of_events_of_one_pixel_in_one_frame() -> None:
    thresholds = {"theta_on": 0.01, "theta_off": 0.01}
    simulator = Simulator(3, 2, only(contrast_response={"k1": 100}, comparator=thresholds), seed=1)
    simulator.advance(still(0, 3, 2), 0)
    events = simulator.advance(still(255, 3, 2), 10_000_000)
    assert len(events) / 6 == pytest.approx(100 * math.log(275 / 20) / 0.01, abs=2)
    assert np.bincount(events["x"]).tolist() == pytest.approx([len(events) / 3] * 3, abs=4)


@pytest.mark.parametrize("camera", ["paper", "noisy"])
def test_threads_do_not_show_in_the_events(camera: str) -> None:
    frames = np.random.default_rng(2).integers(0, 256, (4, 60, 80), np.uint8)
    parameters = Parameters.of(camera).changed({"aps_coupling": {"exposure_kick": 0.1}})
    runs = []
    for threads in (1, 2, 3):
        simulator = Simulator(80, 60, parameters, seed=4, threads=threads)
        events = [simulator.advance(frame, 9000 * i) for i, frame in enumerate(frames)]
        runs.append(np.concatenate(events).tobytes())
    assert len(runs[0]) > 13 * 4800
    assert runs[0] == runs[1] == runs[2]


@pytest.mark.parametrize("coupling", [0.0, 0.02], ids=["ahead", "fed back"])
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_a_stream_gives_the_events_of_frame_by_frame(threads: int, coupling: float) -> None:
    frames = np.random.default_rng(2).integers(0, 256, (5, 60, 80), np.uint8)
    parameters = Parameters.of("noisy").changed(
        {"latency": {"delay_us": 3000}, "crosstalk": {"coupling": coupling}}
    )
    one_by_one = Simulator(80, 60, parameters, seed=4)
    streaming = Simulator(80, 60, parameters, seed=4, threads=threads)
    for start in (0, 60_000):  # a second stream goes on from the first
        timed = [(frame, start + 9000 * i) for i, frame in enumerate(frames)]
        expected = [one_by_one.advance(*frame) for frame in timed]
        found = list(streaming.stream(timed))
        assert [events.tobytes() for events in found] == [events.tobytes() for events in expected]
        assert streaming.complete_us == one_by_one.complete_us
    assert sum(map(len, expected)) > 1000


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("error", [ValueError, OSError])
def test_what_goes_wrong_in_a_stream_comes_after_the_events_before_it(
    error: type[Exception], threads: int
) -> None:
    def frames() -> Iterator[tuple[np.ndarray, int]]:
        yield still(0, 8, 8), 0
        yield still(255, 8, 8), 1000
        yield still(0, 8, 8), 2000
        if error is ValueError:
            yield still(0, 8, 8), 2000  # time stands still
        raise OSError("the cable is out")

    stream = Simulator(8, 8, Parameters.of("paper"), seed=1, threads=threads).stream(frames())
    found = [len(next(stream)) for _ in range(3)]
    assert found[0] == 0
    assert min(found[1:]) > 64
    with pytest.raises(error):
        next(stream)


def test_who_stops_listening_to_a_stream_ends_it() -> None:
    frames = [(still(level, 8, 8), 1000 * i) for i, level in enumerate((0, 255, 0, 255))]
    simulator = Simulator(8, 8, Parameters.of("paper"), seed=1, threads=2)
    stream = simulator.stream(frames)
    assert len(next(stream)) == 0
    assert len(next(stream)) > 64
    stream.close()
    assert len(simulator.advance(still(255, 8, 8), 9000)) > 64  # the third frame had been read


def test_the_same_seed_gives_the_same_events_and_another_does_not() -> None:
    def run(seed: int) -> Events:
        return watch_still(Simulator(30, 30, Parameters.of("typical"), seed=seed), 200, 0.5, 60)

    assert run(5).tobytes() == run(5).tobytes()
    assert run(5).tobytes() != run(6).tobytes()


def test_parameters_change_between_two_frames_and_voltages_stay() -> None:
    simulator = Simulator(50, 50, only(contrast_response={"k1": 1.0}), seed=2)
    simulator.advance(still(100, 50, 50), 0)
    simulator.parameters = simulator.parameters.changed({"contrast_response": {"k1": 0.0}})
    assert len(simulator.advance(still(10, 50, 50), 1000)) == 0
    simulator.parameters = simulator.parameters.changed({"comparator": {"theta_on": 0.5}})
    events = simulator.advance(still(10, 50, 50), 2000)  # those that stood above one half already
    assert events["p"].all()
    assert (events["t"] == 1000).all()
    # without noise or drift the start is the tent on (-1, 1): one eighth lies above one half
    assert stats.binomtest(len(events), 2500, 1 / 8).pvalue > P_LIMIT


def test_a_jump_makes_no_events_and_goes_on_from_there() -> None:
    simulator = Simulator(10, 10, only(contrast_response={"k1": 5}), seed=1)
    simulator.advance(still(10, 10, 10), 5000)
    simulator.jump(still(200, 10, 10), 1000)
    assert len(simulator.advance(still(200, 10, 10), 2000)) == 0
    assert len(simulator.advance(still(10, 10, 10), 3000)) > 0


def test_every_dtype_gives_the_same_events() -> None:
    frames = np.random.default_rng(0).integers(0, 256, (3, 12, 17), np.uint8)
    results = []
    for dtype in (np.uint8, np.int32, np.uint16, np.float32, np.float64):
        simulator = Simulator(17, 12, seed=3)
        results.append(
            b"".join(simulator.advance(f.astype(dtype), 1000 * i).tobytes() for i, f in enumerate(frames))
        )
    assert len(results[0]) > 0
    assert len(set(results)) == 1


def test_a_sensor_of_one_pixel_and_one_of_twelve_million() -> None:
    one = Simulator(1, 1, seed=0)
    assert len(watch_still(one, 255, 10, 1)) > 5
    huge = Simulator(4096, 3072, seed=0)
    huge.advance(np.zeros((3072, 4096), np.uint8), 0)
    image = np.zeros((3072, 4096), np.uint8)
    image[3071, 4095] = 255
    events = huge.advance(image, 10_000)
    corner = events[(events["x"] == 4095) & (events["y"] == 3071)]
    assert len(corner) in range(12, 16)


@pytest.mark.parametrize(
    ("frame", "t_us", "message"),
    [
        (still(1, 5, 4), 2000, "sensor"),
        (still(math.nan, 4, 5), 2000, "not finite"),
        (still(math.inf, 4, 5), 2000, "not finite"),
        (still(1.1e12, 4, 5), 2000, "above 1e\\+12 DN"),
        (still(-1, 4, 5), 2000, "negative"),
        (np.array([["a"] * 4] * 5), 2000, "real numbers"),
        (np.zeros((5, 4), complex), 2000, "real numbers"),
        (still(1, 4, 5), 1000, "does not come after"),
        (still(1, 4, 5), 500, "does not come after"),
        (still(1, 4, 5), 2**40, "hours"),
    ],
)
def test_what_cannot_be_is_refused_and_changes_nothing(
    frame: NDArray[np.void], t_us: int, message: str
) -> None:
    simulator, twin = (Simulator(4, 5, Parameters.of("typical"), seed=1) for _ in range(2))
    for s in (simulator, twin):
        s.advance(still(200, 4, 5), 0)
        s.advance(still(100, 4, 5), 1000)
    with pytest.raises(ValueError, match=message):
        simulator.advance(frame, t_us)
    after = [s.advance(still(240, 4, 5), 3000).tobytes() for s in (simulator, twin)]
    assert len(after[0]) > 0
    assert after[0] == after[1]


@pytest.mark.parametrize("coarser", [0.0, 0.5, -1.0, math.nan, math.inf])
def test_steps_finer_than_effects_ask_are_refused_and_change_nothing(coarser: float) -> None:
    simulator, twin = (Simulator(4, 5, seed=1) for _ in range(2))
    for s in (simulator, twin):
        s.advance(still(200, 4, 5), 0)
    with pytest.raises(ValueError, match="give 1 or more"):
        simulator.advance(still(100, 4, 5), 1000, Limits(coarser))
    after = [s.advance(still(100, 4, 5), 2000).tobytes() for s in (simulator, twin)]
    assert len(after[0]) > 0
    assert after[0] == after[1]


@pytest.mark.parametrize("wrong", [{"width": 0}, {"height": 9000}, {"law": "both"}, {"seed": -1}])
def test_an_impossible_simulator_is_refused(wrong: dict[str, object]) -> None:
    arguments: dict[str, object] = {"width": 3, "height": 3, **wrong}
    with pytest.raises(ValueError, match=r"give|sides"):
        Simulator(**arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("law", ["exact", "paper"])
def test_thresholds_at_their_limits(law: Law) -> None:
    """White to black and back: 2.62 k1, in steps of a thousandth of a threshold, or none of 100."""
    for theta, expected in ((0.001, 5.265 * math.log(275 / 20) / 0.001), (100.0, 0)):
        thresholds = {"theta_on": theta, "theta_off": theta}
        parameters = only(contrast_response={"k1": 5.265}, comparator=thresholds)
        simulator = Simulator(2, 1, parameters, law=law, seed=1)
        simulator.jump(still(255, 2, 1), 0)
        counts = [simulator.advance(still(grey, 2, 1), t) for grey, t in ((0, 10**6), (255, 2 * 10**6))]
        down, up = (len(events) / 2 for events in counts)
        if law == "paper":
            expected *= 255 / 147.5 / math.log(275 / 20)  # its linearisation
        assert down == pytest.approx(expected, abs=2)
        assert up == pytest.approx(expected, abs=2)


def test_a_jump_forward_stamps_nothing_before_what_has_left() -> None:
    """Where the clock becomes coarser at a jump, its ticks begin before events that have left."""
    parameters = only(junction_leak={"k4_per_us": 1e-4})
    simulator = Simulator(8, 8, parameters, seed=1)
    grey = np.full((8, 8), 50, np.uint8)
    simulator.advance(grey, 0)
    before = simulator.advance(grey, 900_000)
    simulator.parameters = parameters.changed({"timestamp_quantum": {"quantum_us": 1_000_000}})
    simulator.jump(grey, 950_000)
    after = simulator.advance(grey, 1_100_000)
    assert simulator.complete_us >= before["t"][-1]
    assert after.size > 0
    assert after["t"][0] >= before["t"][-1]


@pytest.mark.parametrize("camera", ["davis346", "davis240c", "typical", "paper", "ideal", "noisy"])
@pytest.mark.parametrize("law", ["exact", "paper"])
def test_a_snapshot_goes_on_as_its_simulator_does(camera: str, law: Law) -> None:
    """Bit for bit, with still rows drawn ahead, dead times, queues of the readout and events on their way."""
    parameters = Parameters.of(camera).changed(
        {"latency": {"delay_us": 4000, "jitter_us": 500}, "temperature_drift": {"rate_c_per_s": 1}}
    )
    frames = scene_frames(30, 24, 40)
    one = Simulator(40, 24, parameters, law, seed=3)
    for i in range(20):
        one.advance(frames[i // 2], 5000 * i)  # every other interval without a change
    saved = one.snapshot()
    other = Simulator(40, 24, parameters, law, seed=3)
    other.restore(saved)
    count = 0
    for i in range(20, 30):
        went_on, restored = one.advance(frames[i], 5000 * i), other.advance(frames[i], 5000 * i)
        np.testing.assert_array_equal(went_on, restored)
        count += len(went_on)
    assert count > 100


def test_there_is_no_snapshot_before_a_frame() -> None:
    with pytest.raises(ValueError, match="give a frame first"):
        Simulator(4, 4).snapshot()


def scene_frames(count: int, height: int, width: int) -> NDArray[np.uint8]:
    """Bars that move to the right; the lower half stands still."""
    x, i = np.arange(width), np.arange(count)[:, None, None]
    bars = np.where((x + 2 * i) % 16 < 8, 40, 200) + np.zeros((1, height, 1))
    bars[:, height // 2 :] = 90
    return bars.astype(np.uint8)
