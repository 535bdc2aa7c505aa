import numpy as np
import pytest

from voltcam_lab.representations import event_frame, time_surface, voxel_grid
from voltcam_simulator import EVENT

WIDTH, HEIGHT, SPAN_US = 7, 5, 1000


def drawn(count: int, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    events = np.empty(count, EVENT)
    events["t"] = np.sort(rng.integers(0, SPAN_US, count))
    events["x"], events["y"] = rng.integers(WIDTH, size=count), rng.integers(HEIGHT, size=count)
    events["p"] = rng.integers(2, size=count)
    return events


def as_printed(events: np.ndarray, start_us: int, end_us: int, bins: int) -> np.ndarray:
    """The equation, event by event."""
    grid = np.zeros((bins, HEIGHT, WIDTH))
    for t, x, y, p in events.tolist():
        for b in range(bins):
            near = 1 - abs(b - (bins - 1) * (t - start_us) / (end_us - start_us))
            grid[b, y, x] += (1 if p else -1) * max(0.0, near)
    return grid


@pytest.mark.parametrize("bins", [2, 3, 5, 10])
def test_a_voxel_grid_is_what_its_equation_says(bins: int) -> None:
    events = drawn(500)
    np.testing.assert_allclose(
        voxel_grid(events, WIDTH, HEIGHT, 0, SPAN_US, bins), as_printed(events, 0, SPAN_US, bins), atol=1e-4
    )


def test_a_voxel_grid_of_one_slice_sums_polarities() -> None:
    events = drawn(500)
    on, off = event_frame(events, WIDTH, HEIGHT)
    np.testing.assert_allclose(voxel_grid(events, WIDTH, HEIGHT, 0, SPAN_US, 1)[0], on - off, atol=1e-5)


def test_events_at_the_ends_go_into_the_outer_slices() -> None:
    events = np.array([(100, 1, 2, True), (200, 3, 4, False)], EVENT)
    grid = voxel_grid(events, WIDTH, HEIGHT, 100, 200, 5)
    assert (grid[0, 2, 1], grid[4, 4, 3]) == (1, -1)
    assert np.abs(grid).sum() == 2


def test_an_event_frame_counts_by_polarity() -> None:
    events = drawn(300)
    counts = event_frame(events, WIDTH, HEIGHT)
    expected = np.zeros((2, HEIGHT, WIDTH))
    for _, x, y, p in events.tolist():
        expected[0 if p else 1, y, x] += 1
    np.testing.assert_array_equal(counts, expected)


def test_event_frames_are_as_tonic_makes_them() -> None:
    transforms = pytest.importorskip("tonic.transforms", reason="tonic is not installed")
    events = drawn(300)
    # tonic's first plane is OFF
    frames = transforms.ToFrame(sensor_size=(WIDTH, HEIGHT, 2), n_event_bins=1)(events)
    np.testing.assert_array_equal(event_frame(events, WIDTH, HEIGHT), frames[0, ::-1])


def test_a_time_surface_decays_from_the_last_event() -> None:
    events = np.array([(900, 1, 2, True), (400, 1, 2, True), (1000, 3, 4, False)], EVENT)
    surface = time_surface(events, WIDTH, HEIGHT, 1000, tau_us=50)
    expected = np.zeros((2, HEIGHT, WIDTH))
    expected[0, 2, 1], expected[1, 4, 3] = np.exp(-2), 1
    np.testing.assert_allclose(surface, expected, rtol=1e-6)


def test_no_event_is_nothing() -> None:
    none = np.empty(0, EVENT)
    for array, planes in (
        (voxel_grid(none, WIDTH, HEIGHT, 0, 1, 3), 3),
        (event_frame(none, WIDTH, HEIGHT), 2),
        (time_surface(none, WIDTH, HEIGHT, 0), 2),
    ):
        assert array.shape == (planes, HEIGHT, WIDTH)
        assert array.dtype == np.float32
        assert not array.any()
