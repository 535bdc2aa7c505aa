"""Clips of stored recordings, and a training loop on them and on live ones."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'voltcam[learn]'")

from torch.utils.data import DataLoader  # noqa: E402

from voltcam_client.cli import main  # noqa: E402
from voltcam_client.formats import open_writer  # noqa: E402
from voltcam_lab.recordings import load  # noqa: E402
from voltcam_lab.torch import EventClips, Photographs, RecordedClips  # noqa: E402
from voltcam_simulator import EVENT  # noqa: E402

WIDTH, HEIGHT, START_US = 20, 14, 5_000_000
SMALL: dict[str, Any] = {"width": 8, "height": 6, "windows": 3, "window_us": 10_000}


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """An event of each pixel each millisecond; a frame's grey is its number, and they are 10 ms apart."""
    y, x = np.indices((HEIGHT, WIDTH)).reshape(2, -1)
    events = np.empty((100, x.size), EVENT)
    events["t"] = START_US + 1000 * np.arange(100)[:, None]
    events["x"], events["y"], events["p"] = x, y, (x + y) % 2
    path = tmp_path / "walk.h5"
    with open_writer(path, width=WIDTH, height=HEIGHT) as writer:
        writer.events(events.ravel())
        for i in range(11):
            writer.frame(np.full((HEIGHT, WIDTH), 10 * i, np.uint8), START_US + 10_000 * i)
    return path


def test_a_clip_is_a_piece_of_its_recording(recording: Path) -> None:
    clips = RecordedClips([recording], representation="events", **SMALL)
    greys = set()
    for epoch in range(10):
        clip = clips.clip(epoch, 0)
        for events in clip.events:
            assert ((events["t"] >= 0) & (events["t"] < 10_000)).all()
            counts = np.zeros((6, 8), int)
            np.add.at(counts, (events["y"], events["x"]), 1)
            assert (counts == 10).all()  # of every pixel of the clip, and of no other
            assert len({bool((x + y + p) % 2) for _, x, y, p in events.tolist()}) == 1
        # grey rises by 10 in 10 ms
        np.testing.assert_allclose(np.diff(clip.images[:, 0, 0]), 10, atol=1e-3)
        begin_us = (clip.images[0, 0, 0] - 10) * 1000
        first_us = clip.events[0]["t"][0]
        assert (begin_us + first_us) % 1000 == pytest.approx(0, abs=1) or (begin_us + first_us) % 1000 > 999
        greys.add(round(float(clip.images[0, 0, 0]), 1))
    assert len(greys) > 5


def test_places_differ_by_epoch_and_are_the_same_in_workers(recording: Path) -> None:
    clips = RecordedClips([recording] * 3, **SMALL)

    def passed(workers: int) -> list[Any]:
        return [item["images"] for item in DataLoader(clips, batch_size=None, num_workers=workers)]

    first = passed(0)
    assert all(map(torch.equal, first, passed(2)))
    clips.set_epoch(1)
    second = passed(2)
    assert not any(map(torch.equal, first, second))
    assert all(map(torch.equal, second, passed(0)))


@pytest.mark.parametrize("change", [{"width": 21}, {"height": 15}, {"windows": 11}])
def test_what_is_too_small_or_too_short_is_named(recording: Path, change: dict[str, int]) -> None:
    with pytest.raises(
        ValueError, match=r"walk\.h5: its frames are 20 x 14 over 0\.1 s, less than a clip of"
    ):
        RecordedClips([recording], **SMALL | change)[0]


def test_one_loop_trains_on_a_stored_set_and_on_live_clips(tmp_path: Path) -> None:
    """`voltcam dataset make` writes the set; the loop does not know which it has."""
    rng = np.random.default_rng(1)
    videos = tmp_path / "videos"
    videos.mkdir()
    for name in "ab":
        still = np.kron(rng.integers(20, 220, (3, 10), dtype=np.uint8), np.ones((8, 8), np.uint8))
        frames = np.stack([still[:, 2 * i : 2 * i + 32] for i in range(12)])
        np.savez(videos / f"{name}.npz", frames=frames, t_us=10_000 * np.arange(12))
    camera = tmp_path / "tiny.yaml"
    camera.write_text("name: tiny\nwidth: 32\nheight: 24\n")
    made = [
        "dataset",
        "make",
        f"{videos}/*.npz",
        str(tmp_path / "set"),
        "--camera",
        str(camera),
        "--workers",
        "1",
    ]
    assert main(made) == 0
    stored = sorted((tmp_path / "set").rglob("*.h5"))
    assert len(stored) == 2
    assert all(len(load(path).events) > 50 for path in stored)
    asked = {"width": 24, "height": 16, "windows": 4, "window_us": 20_000}
    still_light = [still.astype(np.float32)]
    for clips in (
        RecordedClips(stored, **asked),
        EventClips(Photographs(still_light, 32, 24), "davis346", clips=2, **asked),
    ):
        torch.manual_seed(1)
        network = torch.nn.Conv2d(5, 1, 3, padding=1)
        torch.nn.init.constant_(network.bias, 3.0)  # far from any image
        optimiser = torch.optim.Adam(network.parameters(), lr=0.1)
        losses = []
        for _ in range(30):
            for batch in DataLoader(clips, batch_size=2):
                grids, images = batch["events"].flatten(0, 1), batch["images"].flatten(0, 1) / 255
                loss = ((network(grids)[:, 0] - images) ** 2).mean()
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
                losses.append(loss.item())
        assert losses[-1] < 0.3 * losses[0]
