"""What comes between frames and when; and on a real recording, whether it is what was there."""

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_simulator import EVENT, Camera, Simulator
from voltcam_video import Frame, SourceRequest, open_source
from voltcam_video.upsample import Upsampling, between

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[3] / "shared" / "data"))
WAYS: list[Upsampling] = ["linear", "cubic", "auto", 1, 3]


def shifted(pixels: int, shape: tuple[int, int] = (60, 80)) -> NDArray[np.uint8]:
    y, x = np.mgrid[: shape[0], : shape[1]]
    grey = 120 + 60 * np.sin((x - pixels) / 5) + 40 * np.sin((y + x - pixels) / 7)
    image: NDArray[np.uint8] = np.rint(grey).astype(np.uint8)
    return image


def film(n: int = 6) -> list[Frame]:
    return [Frame(shifted(4 * i), 1_700_000_000_000_000 + 33_333 * i) for i in range(n)]


def filled(out: list[Frame], frames: list[Frame]) -> list[int]:
    """How many frames came between each two, after a look at all of them."""
    real = [i for i, frame in enumerate(out) if any(frame is one for one in frames)]
    assert [id(out[i]) for i in real] == [id(frame) for frame in frames]
    assert (real[0], real[-1]) == (0, len(out) - 1)
    assert not any(
        frame.cut or frame.image.dtype != np.float32 for i, frame in enumerate(out) if i not in real
    )
    return (np.diff(real) - 1).tolist()


@pytest.mark.parametrize("how", WAYS)
def test_real_frames_come_as_they_are_and_time_advances(how: Upsampling) -> None:
    frames = film()
    out = list(between(iter(frames), how))
    counts = filled(out, frames)
    assert all(late.t_us > early.t_us for early, late in pairwise(out))
    if how in ("linear", 1):
        assert counts == [0] * 5
    elif how == 3:
        assert counts == [2] * 5
    else:
        assert all(2 <= count <= 6 for count in counts)


def with_a_cut(frames: list[Frame]) -> list[Frame]:
    frames[3] = replace(frames[3], cut=True)
    return frames


def with_time_set_back(frames: list[Frame]) -> list[Frame]:
    return frames[:3] + [replace(frame, t_us=frame.t_us - 200_000) for frame in frames[3:]]


def with_a_change_of_size(frames: list[Frame]) -> list[Frame]:
    return frames[:3] + [replace(frame, image=frame.image[:50]) for frame in frames[3:]]


@pytest.mark.parametrize("broken", [with_a_cut, with_time_set_back, with_a_change_of_size])
@pytest.mark.parametrize("how", WAYS)
def test_nothing_comes_between_frames_that_do_not_follow(
    how: Upsampling, broken: Callable[[list[Frame]], list[Frame]]
) -> None:
    frames = broken(film())
    counts = filled(list(between(frames, how)), frames)
    assert counts[2] == 0
    if how not in ("linear", 1):
        assert min(counts[:2] + counts[3:]) >= 2


@pytest.mark.parametrize(("how", "delay"), [("linear", 0), ("cubic", 1), ("auto", 0), (3, 0)])
def test_only_the_cubic_waits_for_the_next_frame(how: Upsampling, delay: int) -> None:
    taken: list[Frame] = []

    def camera() -> Iterator[Frame]:
        for frame in film():
            taken.append(frame)
            yield frame

    taken_by_then = [len(taken) for out in between(camera(), how) if any(out is frame for frame in taken)]
    assert taken_by_then == [min(i + 1 + delay, 6) for i in range(6)]


@pytest.mark.parametrize("how", WAYS)
def test_no_frames_and_one_frame(how: Upsampling) -> None:
    assert list(between([], how)) == []
    only = film(1)
    assert filled(list(between(only, how)), only) == []


@pytest.mark.parametrize("how", [0, -1, "off", 2.5])
def test_other_ways_are_refused(how: Any) -> None:
    with pytest.raises(ValueError, match="no way to upsample"):
        between([], how)


@pytest.fixture(scope="module")
def recording() -> list[Frame]:
    """87 frames of a DAVIS240C on a slider: 240 x 180 at 25.8 Hz."""
    folder = DATA / "slider_depth"
    if not folder.is_dir():
        pytest.skip(f"no recording at {folder}: set VOLTCAM_DATA")
    with open_source(SourceRequest(uri=str(folder), pace="fast")) as source:
        return list(source)


def psnr(image: NDArray[Any], truth: NDArray[Any]) -> float:
    return float(10 * np.log10(255**2 / np.mean((image.astype(np.float64) - truth) ** 2)))


def test_frames_that_were_left_out_are_found_again(
    recording: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    """Every second frame, from its neighbours 78 ms apart; the slider stops in the last three intervals."""
    margins_db = []
    for before, truth, after in zip(recording[:-2:2], recording[1:-1:2], recording[2::2], strict=True):
        between_them = list(between([before, after], 2))[1]
        assert abs(between_them.t_us - truth.t_us) < 500
        blend = (before.image.astype(np.float64) + after.image) / 2
        margins_db.append(psnr(between_them.image, truth.image) - psnr(blend, truth.image))
    halves = np.array(margins_db[:22]), np.array(margins_db[22:])
    with capsys.disabled():
        for name, half in zip(("first", "second"), halves, strict=True):
            gain = f"{half.mean():.1f} dB over linear blending, {half.min():.1f} at worst"
            print(f"\nslider_depth, {name} half: {gain}")  # noqa: T201
    assert halves[0].min() > 6
    assert halves[1].mean() > 7
    assert np.sum(np.concatenate(halves) < 3) <= 2  # where it stops, nothing tells how


def test_motion_between_frames_makes_more_real_events(
    recording: list[Frame], capsys: pytest.CaptureFixture[str]
) -> None:
    """Correlation of 50 ms event-count images with those of the camera itself."""
    camera = Camera.load("davis240c")
    seconds, x, y = np.loadtxt(DATA / "slider_depth" / "events.txt", usecols=(0, 1, 2), max_rows=250_000).T
    starts = np.arange(100_000, 700_000, 50_000)

    def counts(t_us: NDArray[Any], x: NDArray[Any], y: NDArray[Any]) -> NDArray[Any]:
        edges = [*starts, starts[-1] + 50_000], range(181), range(241)
        return np.histogramdd((t_us, y, x), edges)[0].reshape(starts.size, -1)

    assert seconds[-1] * 1e6 > starts[-1] + 50_000
    real = counts(seconds * 1e6, x, y)
    found = {}
    for how in ("linear", "cubic", "auto"):
        simulator = Simulator(camera.width, camera.height, camera.parameters, seed=1)
        events = np.concatenate(
            [np.empty(0, EVENT), *(simulator.advance(f.image, f.t_us) for f in between(recording[:21], how))]
        )
        made = counts(events["t"], events["x"], events["y"])
        same = np.diag(np.corrcoef(made, real)[: starts.size, starts.size :])
        found[how] = float(np.median(same))
    with capsys.disabled():
        print("\nslider_depth, correlation of 50 ms event-count images:", found)  # noqa: T201
    assert found["auto"] > found["linear"] + 0.04
    assert found["cubic"] > found["linear"] - 0.005
