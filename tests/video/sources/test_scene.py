import numpy as np
import pytest

from voltcam_video import SourceRequest, open_source
from voltcam_video.sources import scene

TIMES_US = range(0, scene.PERIOD_US, 333_331)
SIZES = [(346, 260), (240, 180), (640, 480), (33, 7)]


def test_the_same_time_gives_the_same_image_at_any_epoch() -> None:
    for t_us in (0, 123_456, 19_999_999):
        epoch_us = t_us + 85_000_000 * scene.PERIOD_US
        assert np.array_equal(scene.render(t_us), scene.render(epoch_us))


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_static_areas_never_change(width: int, height: int) -> None:
    areas = scene.static_areas(width, height)
    assert len({area.grey for area in areas}) == 4
    assert areas[0].grey < 20
    for t_us in TIMES_US:
        image = scene.render(t_us, width, height)
        assert image.shape == (height, width)
        for area in areas:
            patch = image[area.rows, area.columns]
            assert patch.shape == (area.height, area.width)
            assert (patch == area.grey).all()


def test_static_areas_are_large_enough_to_measure_leak() -> None:
    assert all(area.width * area.height >= 1600 for area in scene.static_areas())


def test_texture_moves_as_a_whole() -> None:
    # In 1/6 s it moves 12 pixels right and 9 down; looked at left of the disc, below the static areas.
    before, after = scene.render(1_000_000), scene.render(1_000_000 + 1_000_000 // 6)
    then = after[100 + 9 : 190 + 9, 10 + 12 : 90 + 12].astype(int)
    assert np.abs(then - before[100:190, 10:90]).max() <= 1
    assert before[100:190, 10:90].std() > 20


def test_most_pixels_change_from_frame_to_frame() -> None:
    changed = [(scene.render(t) != scene.render(t + 16_667)).mean() for t in TIMES_US]
    assert 0.6 < np.mean(changed) < 0.95


def test_motion_is_continuous() -> None:
    # A quarter of the time makes a quarter of the change, up to rounding to 8 bits.
    image = scene.render(0).astype(int)
    whole = np.abs(scene.render(16_000) - image).mean()
    quarter = np.abs(scene.render(4_000) - image).mean()
    assert 0.2 < quarter / whole < 0.35


def test_patch_flickers_at_8_hz() -> None:
    x, y, w, h = scene.FLICKER
    greys = [int(scene.render(t)[y + h // 2, x + w // 2]) for t in (0, 31_250, 62_500, 93_750, 125_000)]
    assert greys == [128, 218, 128, 38, 128]


def test_source_keeps_the_size_and_rate_asked_for() -> None:
    request = SourceRequest(width=64, height=48, fps=250, pace="fast")
    with open_source(request) as source:
        frames = [source.read() for _ in range(3)]
        assert source.granted["fps"] == 250
    assert [frame.t_us for frame in frames if frame] == [0, 4000, 8000]
    assert all(frame and frame.image.shape == (48, 64) for frame in frames)


def test_it_begins_years_on_without_drawing_what_is_before() -> None:
    late = scene.PERIOD_US * 1_000_000 + 3_000_000
    request = SourceRequest(uri="scene", width=64, height=48, fps=10_000, pace="fast", start_s=late / 1e6)
    with open_source(request) as source:
        frame = source.read()
    assert frame is not None
    np.testing.assert_array_equal(frame.image, scene.render(3_000_000, 64, 48))
