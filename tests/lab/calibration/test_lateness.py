"""How late events are: simulated ones are moved until one measure says the same of both."""

import pytest

from voltcam_lab.calibration.lateness import USUAL_US, as_late_as, clocks_apart_us
from voltcam_lab.health import inspect
from voltcam_lab.health.lag import Lag
from voltcam_lab.light.scene import scene_of
from voltcam_lab.models.model import MODELS, simulate
from voltcam_lab.recordings import Footage
from voltcam_simulator import Parameters

from ..health.made import HEIGHT, WIDTH, healthy

TRUE_US = 14_000.0
CAMERA = Parameters.of("ideal").changed({"contrast_response": {"k1": 4.0}})


@pytest.fixture(scope="module")
def late() -> tuple[Footage, object]:
    """A camera of ours, 14 ms late: the recording tells its lag to 5."""
    given = healthy()
    scene = scene_of(given.frames, given.frame_t_us, "cubic")
    camera = CAMERA.changed({"latency": {"delay_us": TRUE_US}})
    events = simulate(MODELS["exact"](WIDTH, HEIGHT, camera, 3), scene)
    return Footage(events, WIDTH, HEIGHT, given.frames, given.frame_t_us), scene


def test_the_delay_of_the_camera_is_found(late: tuple[Footage, object]) -> None:
    footage, scene = late
    found, words = as_late_as(footage, scene, CAMERA, seed=1)  # type: ignore[arg-type]
    assert found.latency.delay_us == pytest.approx(TRUE_US, abs=500)
    assert f"{inspect(footage).lag.lag_us / 1000:.1f}" in words
    assert found.changed({"latency": {"delay_us": 0.0}}) == CAMERA


def test_a_delay_within_its_interval_stays(late: tuple[Footage, object]) -> None:
    footage, scene = late
    near = CAMERA.changed({"latency": {"delay_us": TRUE_US + 40.0}})
    found, words = as_late_as(footage, scene, near, seed=1)  # type: ignore[arg-type]
    assert found == near
    assert f"{TRUE_US + 40:.0f} us" in words


def test_what_makes_both_late_does_not_widen_the_interval(late: tuple[Footage, object]) -> None:
    footage, scene = late
    off = CAMERA.changed({"latency": {"delay_us": TRUE_US + 700.0}})
    assert inspect(footage).lag.uncertainty_us > 1000  # half the blocks tell nothing, of either alike
    found, _ = as_late_as(footage, scene, off, seed=1)  # type: ignore[arg-type]
    assert found.latency.delay_us == pytest.approx(TRUE_US, abs=500)


def test_a_camera_without_events_keeps_its_delay(late: tuple[Footage, object]) -> None:
    footage, scene = late
    blind = CAMERA.changed({"comparator": {"theta_on": 90.0, "theta_off": 90.0}})
    assert as_late_as(footage, scene, blind, seed=1)[0] == blind  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("lag_us", "score", "apart_us"),
    [
        (500.0, 30.0, 0.0),  # a camera's own
        (11_000.0, 30.0, 0.0),
        (-14_000.0, 30.0, -14_000 - USUAL_US),  # frames stamped as they arrive
        (25_000.0, 30.0, 25_000 - USUAL_US),
        (-14_000.0, 3.0, 0.0),  # chance
    ],
)
def test_clocks_are_apart_by_a_lag_that_no_camera_has(lag_us: float, score: float, apart_us: float) -> None:
    assert clocks_apart_us(Lag(lag_us, 500.0, 0.9, score, 0.1, 0.0, 100.0, (lag_us,) * 8)) == apart_us
