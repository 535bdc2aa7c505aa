"""All measures at once: the same is at no distance, and halves of one stream are near."""

import os
from pathlib import Path

import numpy as np
import pytest
from tests.lab.distances.made import WHOLE, poisson, still_light

from voltcam_lab.distances import (
    DISTANCES,
    HEADLINES,
    MEASURES,
    FrameLight,
    Region,
    Yardstick,
    closest,
    gap,
)
from voltcam_lab.recordings import load

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[4] / "shared" / "data"))


def test_a_stream_is_at_no_distance_from_itself() -> None:
    real = poisson(1)
    row = Yardstick(real, WHOLE, still_light()).distances(real)
    assert list(row) == list(MEASURES)
    for name, measure in MEASURES.items():
        if measure.best is not None:
            within = 1e-4 if name == "nats" else 1e-12  # a fit, on random halves of the events
            assert row[name] == pytest.approx(measure.best, abs=within), name


def test_halves_of_a_poisson_stream_are_as_good_as_the_same() -> None:
    yardstick = Yardstick(poisson(4, rate_hz=60), WHOLE, still_light())
    for floor in (yardstick.floor_by_pixels(), yardstick.floor_by_time()):
        assert floor["W1"] < 0.01
        assert floor["TV"] < 0.02
        assert floor["TVs"] < 0.03
        assert floor["pair"] < 0.01
        assert floor["noise"] < 0.5
        assert abs(floor["AUC"] - 0.5) < 0.15
        assert abs(floor["ratio"]) < 0.05
        assert floor["quiet_on"] < 0.5


def test_too_few_events_are_no_distance() -> None:
    few = poisson(1)[:10]
    row = Yardstick(few, WHOLE, still_light()).distances(few)
    assert all(np.isnan(row[name]) for name in ("W1", "TV", "TVs", "pair", "AUC", "nats"))
    nothing = Yardstick(few[:0], WHOLE, still_light()).distances(few[:0])
    assert np.isnan(nothing["b4"])
    assert np.isnan(nothing["dispersion"])
    assert nothing["on"] == 0


@pytest.mark.skipif(not (DATA / "slider_depth").is_dir(), reason="slider_depth is not on this machine")
def test_the_floors_of_a_real_recording() -> None:
    """As another implementation found them: W1 .002, TVs .010, pair .002, b4 .977, AUC .51."""
    recording = load(DATA / "slider_depth")
    t_us = recording.frame_t_us
    windows = np.concatenate([t_us[:, None] + window for window in ([-400, -50], [550, 1500])])
    region = Region.whole(240, 180, int(t_us[0]), int(t_us[-1])).without(windows)
    floor = Yardstick(recording.events, region, FrameLight(recording.frames, t_us)).floor_by_pixels()
    assert floor["W1"] == pytest.approx(0.002, abs=0.001)
    assert floor["TVs"] == pytest.approx(0.010, abs=0.003)
    assert floor["pair"] == pytest.approx(0.002, abs=0.001)
    assert floor["b4"] == pytest.approx(0.977, abs=0.01)
    assert floor["AUC"] == pytest.approx(0.51, abs=0.04)


NAN = float("nan")


def test_a_gap_is_what_is_beyond_the_floor_on_either_side_of_the_best() -> None:
    """b4 is best at 1 and AUC at .5, from which both ways lead away."""
    assert gap("W1", 0.3, 0.1) == pytest.approx(0.2)
    assert gap("b4", 0.9, 0.97) == pytest.approx(0.07)
    assert [gap("AUC", 0.7, 0.48), gap("AUC", 0.3, 0.52)] == pytest.approx([0.18, 0.18])
    assert gap("W1", 0.05, 0.1) == 0
    assert np.isnan(gap("W1", NAN, 0.1))


def test_the_closest_model_is_that_nearest_to_the_best() -> None:
    table = {
        "low": {"AUC": 0.35, "W1": NAN},
        "high": {"AUC": 0.6, "W1": NAN},
        "unknown": {"AUC": NAN, "W1": NAN},
    }
    assert closest(table, "AUC") == "high"
    assert closest(table, "W1") is None


def test_measures_with_a_best_are_the_distances() -> None:
    assert {name for name, one in MEASURES.items() if one.best is None}.isdisjoint(DISTANCES)
    assert set(HEADLINES) <= set(DISTANCES)
