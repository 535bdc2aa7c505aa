"""The models under one interface, and thresholds fitted to wanted numbers of events."""

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_lab.light.scene import Scene
from voltcam_lab.models.esim import EsimParameters
from voltcam_lab.models.model import (
    MODELS,
    PUBLISHED,
    fit_thresholds,
    simulate,
    with_fitted_thresholds,
    with_thresholds,
)
from voltcam_lab.models.v2e import V2eParameters
from voltcam_simulator import EVENT, Parameters

Events = NDArray[np.void]


def wave(width: int = 60, height: int = 45, frames: int = 100, fps: float = 250.0) -> Scene:
    """A plaid moving two ways at once."""
    y, x = np.mgrid[:height, :width]
    images = np.stack(
        [110 + 55 * np.sin(0.2 * x - 0.15 * k) + 45 * np.sin(0.3 * y + 0.1 * k) for k in range(frames)]
    ).astype(np.float32)
    t_us = np.round(np.arange(frames) * 1e6 / fps).astype(np.int64)
    return Scene(images, t_us, images, t_us)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return wave()


@pytest.mark.parametrize("name", MODELS)
def test_each_model_gives_sorted_events_that_its_seed_repeats(name: str, scene: Scene) -> None:
    def run(seed: int) -> Events:
        parameters = with_thresholds(PUBLISHED[name](), 0.4, 0.4)
        return simulate(MODELS[name](scene.width, scene.height, parameters, seed), scene)

    events = run(1)
    assert events.dtype == EVENT
    assert len(events) > 1000
    assert (np.diff(events["t"]) >= 0).all()
    assert scene.t_us[0] <= events["t"][0] <= events["t"][-1] <= scene.t_us[-1]
    assert np.array_equal(events, run(1))
    assert not np.array_equal(events, run(2))


@pytest.mark.parametrize("name", MODELS)
def test_none_means_the_published_parameters(name: str, scene: Scene) -> None:
    makers = [MODELS[name](scene.width, scene.height, p, 3) for p in (None, PUBLISHED[name]())]
    assert np.array_equal(*(simulate(model, scene) for model in makers))


@pytest.mark.parametrize("parameters", [EsimParameters(), V2eParameters.noisy(), Parameters.of("typical")])
def test_with_thresholds_changes_nothing_else(
    parameters: EsimParameters | V2eParameters | Parameters,
) -> None:
    changed = with_thresholds(parameters, 0.7, 0.6)
    assert changed != parameters
    if isinstance(parameters, Parameters):
        back = parameters.comparator
        assert (changed.comparator.theta_on, changed.comparator.theta_off) == (0.7, 0.6)
    else:
        back = parameters
        assert (changed.theta_on, changed.theta_off) == (0.7, 0.6)
    assert with_thresholds(changed, back.theta_on, back.theta_off) == parameters


@pytest.mark.parametrize(("name", "unit"), [("exact", 1.0), ("paper", 1.0), ("esim", 0.3), ("v2e", 0.3)])
@pytest.mark.parametrize(("on", "off"), [(1.4, 0.8), (0.7, 1.1)])
def test_thresholds_are_found_again_from_the_counts_they_give(
    name: str, unit: float, on: float, off: float, scene: Scene
) -> None:
    """Another seed: other noise and mismatch, the same statistics. Counts to 1 %; thresholds within 4 %, as
    the counts go with their inverse and, beyond the 1 %, in steps."""
    hidden = with_thresholds(PUBLISHED[name](), on * unit, off * unit)
    events = simulate(MODELS[name](scene.width, scene.height, hidden, 7), scene)
    wanted = int(events["p"].sum()), int((~events["p"]).sum())
    found = with_fitted_thresholds(name, scene, *wanted, seed=8)
    again = simulate(MODELS[name](scene.width, scene.height, found, 8), scene)
    assert again["p"].sum() == pytest.approx(wanted[0], rel=0.0101, abs=2)
    assert (~again["p"]).sum() == pytest.approx(wanted[1], rel=0.0101, abs=2)
    thresholds = found.comparator if isinstance(found, Parameters) else found
    assert thresholds.theta_on == pytest.approx(on * unit, rel=0.04)
    assert thresholds.theta_off == pytest.approx(off * unit, rel=0.04)


class Counting:
    """As many events as powers of the thresholds say, each polarity also held back by the other's."""

    def __init__(self, theta_on: float, theta_off: float) -> None:
        self.on = int(9000 * theta_on**-1.6 * theta_off**0.4)
        self.off = int(4000 * theta_off**-0.8 * theta_on**0.2)

    def advance(self, image: object, t_us: int, /) -> Events:
        events = np.zeros(self.on + self.off, EVENT)
        events["p"][: self.on] = True
        return events


@pytest.mark.parametrize(("on", "off"), [(300, 5000), (60_000, 900), (9000, 4000)])
def test_it_takes_few_simulations_also_far_from_the_start(on: int, off: int) -> None:
    image = np.zeros((1, 1, 1), np.float32)
    instant = Scene(image, np.zeros(1, np.int64), image, np.zeros(1, np.int64))
    made: list[tuple[float, float]] = []

    def make(theta_on: float, theta_off: float) -> Counting:
        made.append((theta_on, theta_off))
        return Counting(theta_on, theta_off)

    found = Counting(*fit_thresholds(make, instant, on, off, start=1.0))
    assert found.on == pytest.approx(on, rel=0.0101)
    assert found.off == pytest.approx(off, rel=0.0101)
    assert len(made) <= 12


def test_only_what_counts_is_counted(scene: Scene) -> None:
    """Half of the time masked, as exposure windows are: thresholds for half of the events."""

    def early(events: Events) -> Events:
        return events[events["t"] < scene.t_us[50]]

    events = simulate(MODELS["esim"](scene.width, scene.height, EsimParameters(0.3, 0.3), 1), scene)
    wanted = early(events)
    counts = int(wanted["p"].sum()), int((~wanted["p"]).sum())
    found = with_fitted_thresholds("esim", scene, *counts, seed=1, counted=early)
    assert isinstance(found, EsimParameters)
    assert (found.theta_on, found.theta_off) == pytest.approx((0.3, 0.3), rel=0.03)


def test_a_single_image_gives_no_events() -> None:
    scene = wave(frames=1)
    assert all(len(simulate(m(scene.width, scene.height, None, 0), scene)) == 0 for m in MODELS.values())
