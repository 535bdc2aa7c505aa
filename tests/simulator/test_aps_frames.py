"""APS frames: the mean light of each exposure, in closed form, however the time is cut."""

import numpy as np
import pytest

from voltcam_simulator import ApsFrames, Parameters
from voltcam_simulator.effects.aps_coupling import ApsCoupling

WIDTH, HEIGHT = 4, 10
TIMES = {"frame_period_us": 10_000, "exposure_us": 500, "row_us": 35.25, "offset_us": 1234}
EXPOSED_US = 352  # 10 rows of 35.25 us
COUPLING = ApsCoupling(**TIMES)


def rising(t_us: float) -> np.ndarray:
    """Grey levels that rise by one in 200 us, in 1..240 during 50 ms; and columns that differ."""
    return (t_us / 200 + np.arange(WIDTH) * np.ones((HEIGHT, 1))).astype(np.float32)


def watch(times_us: list[int], coupling: ApsCoupling = COUPLING) -> list:
    frames = ApsFrames(HEIGHT)
    return [each for t in times_us for each in frames.advance(coupling, rising(t), t)]


def test_a_frame_is_the_light_in_the_middle_of_its_exposure() -> None:
    """Of light that rises steadily, the mean is that of the middle."""
    seen = watch(list(range(0, 50_001, 5000)))
    assert [frame.exposure_us for frame in seen] == [
        (1234 + EXPOSED_US + 10_000 * i, 1234 + EXPOSED_US + 500 + 10_000 * i) for i in range(5)
    ]
    assert [frame.frame_us for frame in seen] == [
        (1234 + 10_000 * i, 1234 + 705 + 500 + 10_000 * i) for i in range(5)
    ]
    for frame in seen:
        np.testing.assert_array_equal(frame.image, np.rint(rising(sum(frame.exposure_us) / 2 + 0.5)))
        assert frame.image.dtype == np.uint8


@pytest.mark.parametrize("pieces", [1, 2, 7, 300, 5000])
def test_it_does_not_matter_how_time_is_cut(pieces: int) -> None:
    """Cuts in an exposure, and many exposures in a piece; light is straight, so its cuts show nothing."""
    inner = np.random.default_rng(pieces).choice(np.arange(1, 50_000), pieces - 1, replace=False)
    seen = watch([0, *np.sort(inner).tolist(), 50_000])
    whole = watch([0, 50_000])
    assert len(seen) == len(whole) == 5
    for own, other in zip(seen, whole, strict=True):
        assert own[1:] == other[1:]
        assert np.abs(own.image.astype(int) - other.image).max() <= 1  # a mean of floats at half a level


def test_a_step_in_the_middle_of_an_exposure_shows_half() -> None:
    frames, dark, bright = ApsFrames(HEIGHT), np.zeros((HEIGHT, WIDTH)), np.full((HEIGHT, WIDTH), 200.0)
    middle = 1234 + EXPOSED_US + 250
    for image, t_us in ((dark, 0), (dark, middle), (bright, middle + 1), (bright, 9000)):
        seen = frames.advance(COUPLING, image, t_us)
    (frame,) = seen
    assert set(frame.image.ravel()) == {100}


def test_times_are_those_of_the_kicks() -> None:
    """One set of parameters for both: the exposure's kick goes up and down when a frame's exposure does."""
    parameters = Parameters().changed({"aps_coupling": TIMES})
    times = parameters.aps_coupling.times(HEIGHT)
    frame = watch([0, 9000])[0]
    begin_ns = 1_234_000
    assert frame.exposure_us == ((begin_ns + times.exposed_ns) // 1000, (begin_ns + times.read_ns) // 1000)
    assert frame.frame_us == (1234, (begin_ns + times.end_ns) // 1000)


def test_a_period_that_is_too_short_is_taken_several_at_a_time() -> None:
    """Two scans of 352.5 us and 500 us of exposure do not fit into 1 ms."""
    seen = watch([0, 50_000], ApsCoupling(**TIMES | {"frame_period_us": 1000}))
    begins = np.array([frame.frame_us for frame in seen])
    assert set(np.diff(begins[:, 0])) == {2000}
    assert (begins[1:, 0] >= begins[:-1, 1]).all()


def test_what_is_exposed_in_a_jump_is_lost() -> None:
    frames = ApsFrames(HEIGHT)
    frames.jump(rising(0), 0)
    assert frames.advance(COUPLING, rising(1700), 1700) == []  # in the first exposure
    frames.jump(rising(1800), 1800)
    (frame,) = frames.advance(COUPLING, rising(13_000), 13_000)
    assert frame.frame_us[0] == 11_234


def test_new_times_begin_with_a_new_frame() -> None:
    frames = ApsFrames(HEIGHT)
    frames.jump(rising(0), 0)
    frames.advance(COUPLING, rising(1700), 1700)
    later = ApsCoupling(**TIMES | {"exposure_us": 1000})
    (frame,) = frames.advance(later, rising(13_000), 13_000)
    assert frame.exposure_us == (11_586, 12_586)
