"""Clips that are simulated in a loader's workers."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'voltcam[learn]'")

from torch.utils.data import DataLoader  # noqa: E402

from voltcam_lab.drawn_camera import CameraDistribution  # noqa: E402
from voltcam_lab.models.esim import Esim  # noqa: E402
from voltcam_lab.representations import event_frame, time_surface, voxel_grid  # noqa: E402
from voltcam_lab.torch import EventClips, Photographs  # noqa: E402
from voltcam_simulator import Camera, Simulator  # noqa: E402

WIDTH, HEIGHT, WINDOWS, WINDOW_US = 24, 16, 3, 10_000


def pictures(count: int = 3) -> list[np.ndarray]:
    rng = np.random.default_rng(1)
    return [np.kron(rng.uniform(20, 200, (10, 12)), np.ones((6, 6))).astype(np.float32) for _ in range(count)]


def scenery() -> Photographs:
    return Photographs(pictures(), 32, 24, speed_px_s=(200, 400))


def made(camera: Any = "davis240c", **more: Any) -> EventClips:
    asked = {"width": WIDTH, "height": HEIGHT, "windows": WINDOWS, "window_us": WINDOW_US, "clips": 4, **more}
    return EventClips(scenery(), camera, **asked)


def passed(clips: EventClips, workers: int, **more: Any) -> list[torch.Tensor]:
    """The grids of a pass, in an order that does not depend on the workers."""
    loader = DataLoader(clips, batch_size=None, num_workers=workers, **more)
    return sorted((item["events"] for item in loader), key=lambda grid: grid.flatten().tolist())


def same(a: list[torch.Tensor], b: list[torch.Tensor]) -> bool:
    return len(a) == len(b) and all(map(torch.equal, a, b))


def test_an_item_has_a_grid_and_an_image_for_each_window() -> None:
    for item in made():
        assert item["events"].shape == (WINDOWS, 5, HEIGHT, WIDTH)
        assert item["images"].shape == (WINDOWS, HEIGHT, WIDTH)
        assert item["events"].dtype == item["images"].dtype == torch.float32
        assert item["events"].abs().sum() > 0


def test_clips_are_the_same_on_any_number_of_workers() -> None:
    alone = passed(made(), 0)
    assert len(alone) == 4
    assert same(passed(made(), 1), alone)
    assert same(passed(made(), 2), alone)


@pytest.mark.parametrize("persistent", [False, True])
def test_each_pass_is_another_epoch(persistent: bool) -> None:
    clips = made()
    loader = DataLoader(clips, batch_size=None, num_workers=2, persistent_workers=persistent)
    key = lambda grid: grid.flatten().tolist()  # noqa: E731
    first, second = (sorted((item["events"] for item in loader), key=key) for _ in range(2))
    assert not any(torch.equal(a, b) for a in first for b in second)
    alone = made()
    assert same(passed(alone, 0), first)
    assert same(passed(alone, 0), second)
    alone.set_epoch(0)
    assert same(passed(alone, 0), first)


def test_seeds_and_numbers_give_other_clips() -> None:
    grids = [item["events"] for seed in (0, 1) for item in made(seed=seed)]
    assert all(not torch.equal(a, b) for i, a in enumerate(grids) for b in grids[:i])


def test_without_a_number_of_clips_it_does_not_end() -> None:
    stream = iter(made(clips=None))
    assert len([next(stream) for _ in range(6)]) == 6


def test_events_are_those_of_the_whole_clip_in_windows() -> None:
    """Against the simulator, shown the same frames at once."""
    camera = Camera.load("davis240c")
    clips = made(camera, seed=3)
    clip = clips.clip(0, 2)
    of_scenery, of_sensor = np.random.default_rng([3, 0, 2]).spawn(2)
    of_sensor.integers(1)  # which camera, of one
    simulator = Simulator(WIDTH, HEIGHT, camera.parameters, "exact", int(of_sensor.integers(2**31)), 1)
    frames = list(scenery().clip(WIDTH, HEIGHT, WINDOWS * WINDOW_US, of_scenery))
    events = np.concatenate([simulator.advance(frame.image, frame.t_us) for frame in frames])
    events = events[events["t"] < WINDOWS * WINDOW_US]
    assert len(events) > 20
    together = [each.copy() for each in clip.events]
    for window, each in enumerate(together):
        assert ((each["t"] >= 0) & (each["t"] < WINDOW_US)).all()
        each["t"] += window * WINDOW_US
    np.testing.assert_array_equal(np.concatenate(together), events)
    at = {frame.t_us: frame.image for frame in frames}
    for window in range(WINDOWS):
        np.testing.assert_array_equal(clip.images[window], at[(window + 1) * WINDOW_US])


def test_images_between_frames_lie_on_a_straight_line() -> None:
    class Rising:
        def clip(self, width: int, height: int, span_us: int, rng: np.random.Generator) -> Any:
            from voltcam_video import Frame

            for t_us in (5_000, 11_000, 29_000, 47_000):
                yield Frame(np.full((height, width), t_us / 1000, np.float32), t_us)

    clips = EventClips(Rising(), "ideal", width=8, height=8, windows=4, window_us=10_000)
    assert clips.clip(0, 0).images[:, 0, 0].tolist() == pytest.approx([15, 25, 35, 45])


@pytest.mark.parametrize("representation", ["voxel_grid", "time_surface", "event_frame"])
def test_a_representation_is_the_named_one(representation: Any) -> None:
    clips = made(representation=representation, bins=4, tau_us=7_000.0)
    (item, *_), clip = list(clips), clips.clip(0, 0)
    for window, events in zip(item["events"].numpy(), clip.events, strict=True):
        expected = {
            "voxel_grid": lambda e: voxel_grid(e, WIDTH, HEIGHT, 0, WINDOW_US, 4),
            "time_surface": lambda e: time_surface(e, WIDTH, HEIGHT, WINDOW_US, 7_000.0),
            "event_frame": lambda e: event_frame(e, WIDTH, HEIGHT),
        }[representation](events)
        np.testing.assert_array_equal(window, expected)


def test_raw_events_come_as_rows() -> None:
    clips = made(representation="events")
    (item, *_), clip = list(clips), clips.clip(0, 0)
    for rows, events in zip(item["events"], clip.events, strict=True):
        assert rows.dtype == torch.int64
        assert rows.tolist() == [[int(value) for value in row] for row in events.tolist()]


def test_transforms_of_tonic_work() -> None:
    transforms = pytest.importorskip("tonic.transforms", reason="tonic is not installed")
    chain = transforms.Compose(
        [
            transforms.RandomFlipLR(sensor_size=(WIDTH, HEIGHT, 2), p=1.0),
            transforms.ToFrame(sensor_size=(WIDTH, HEIGHT, 2), n_time_bins=4),
        ]
    )
    clips = made(representation=chain)
    (item, *_), clip = list(clips), clips.clip(0, 0)
    assert item["events"].shape == (WINDOWS, 4, 2, HEIGHT, WIDTH)
    for window, events in zip(item["events"].numpy(), clip.events, strict=True):
        flipped = events.copy()
        flipped["x"] = WIDTH - 1 - flipped["x"]
        of_tonic = chain.transforms[1](flipped)
        assert of_tonic.any()
        np.testing.assert_array_equal(window, of_tonic)


def test_cameras_are_drawn_for_each_clip() -> None:
    cameras = CameraDistribution.of("ideal", {"comparator": {"theta_on": {"log_uniform": [0.3, 3.0]}}})
    on = [int(sum(each["p"].sum() for each in made(cameras).clip(0, number).events)) for number in range(4)]
    one = [int(sum(each["p"].sum() for each in made("ideal").clip(0, number).events)) for number in range(4)]
    ratios = np.array(on) / one
    assert ratios.max() > 1.3 * ratios.min()


def test_any_other_model_may_stand_for_the_camera() -> None:
    def esim(width: int, height: int, gamma: float, rng: np.random.Generator) -> Esim:
        assert gamma == 1
        return Esim(width, height, seed=int(rng.integers(9)))

    assert made(esim).clip(0, 0).images.shape == (WINDOWS, HEIGHT, WIDTH)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"width": 0}, "width is a whole number from 1"),
        ({"windows": 0}, "windows is"),
        ({"window_us": 0}, "window_us is"),
        ({"representation": "voxels"}, "no representation 'voxels'"),
    ],
)
def test_what_cannot_be_is_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        made(**change)


def test_an_unreadable_camera_is_refused_at_once(tmp_path: Path) -> None:
    with pytest.raises((ValueError, OSError)):
        made(tmp_path / "none.yaml")
