"""The simulator as a user has it: frames in, events out."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats

from voltcam_simulator import EVENT, Law, Limits, Parameters, Simulator

from .scenes import Events, only, still, watch_still


@pytest.mark.parametrize("t0_us", [0, 1_763_000_000_000_000, -(10**15)])
def test_the_start_of_the_time_line_does_not_matter(t0_us: int) -> None:
    def run(start: int) -> Events:
        simulator = Simulator(20, 20, Parameters.of("paper"), seed=9)
        return watch_still(simulator, 90, 4, 30, start)

    events, reference = run(t0_us), run(0)
    assert len(events) > 0
    assert (events["t"] - t0_us).tolist() == reference["t"].tolist()


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
    assert stats.binomtest(len(events), 2500, 1 / 8).pvalue > 1e-4


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
