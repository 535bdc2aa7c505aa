"""The study itself, at small size."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'voltcam[learn]'")

from voltcam_client.formats import open_writer  # noqa: E402
from voltcam_simulator import Parameters, Simulator  # noqa: E402

from . import __main__ as study  # noqa: E402
from . import measures, real  # noqa: E402
from .clips import Clips  # noqa: E402
from .contenders import ABLATIONS, MODELS, OURS, sensor_of  # noqa: E402
from .network import BINS, FireNet, normalised  # noqa: E402
from .results import Run, ahead_by_seed, folder_of, runs, separated  # noqa: E402
from .training import Budget, trained  # noqa: E402

torch.set_num_threads(1)  # so small a network only waits for others


def frames(count: int = 14, width: int = 36, height: int = 24) -> np.ndarray:
    """A bright square that moves over a slope."""
    images = np.broadcast_to(np.linspace(40, 120, width), (count, height, width)).copy()
    for i, image in enumerate(images):
        image[6:18, 2 * i : 2 * i + 8] = 200
    return images.astype(np.uint8)


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """A folder of recordings with a small `slider_depth`."""
    folder = tmp_path / "data" / "slider_depth"
    (folder / "images").mkdir(parents=True)
    images = frames()
    simulator = Simulator(images.shape[2], images.shape[1], Parameters.of("davis240c"), seed=1)
    with open_writer(folder / "events.txt", width=images.shape[2], height=images.shape[1]) as writer:
        for i, image in enumerate(images):
            writer.events(simulator.advance(image, 40_000 * i))
            cv2.imwrite(str(folder / "images" / f"{i}.png"), image)
    lines = "".join(f"{i * 0.04:.6f} images/{i}.png\n" for i in range(len(images)))
    (folder / "images.txt").write_text(lines)
    return folder.parent


@pytest.fixture
def photographs(tmp_path: Path) -> Path:
    folder = tmp_path / "photographs"
    folder.mkdir()
    cv2.imwrite(str(folder / "a.png"), np.random.default_rng(1).integers(0, 255, (60, 80, 3), dtype=np.uint8))
    return folder


def some_clips() -> Clips:
    generator = torch.Generator().manual_seed(1)
    images = torch.full((4, 5, 16, 16), 0.7).half()
    grids = torch.randn(4, 5, BINS, 16, 16, generator=generator).half()
    return Clips(grids, images, 7)


def test_the_network_is_of_firenet_s_size_and_remembers() -> None:
    network = FireNet()
    assert sum(weights.numel() for weights in network.parameters()) == 37_777
    grid = torch.randn(2, BINS, 8, 12)
    first, state = network(grid)
    again, _ = network(grid, state)
    assert first.shape == (2, 1, 8, 12)
    assert not torch.allclose(first, again)


def test_a_grid_is_normalised_over_what_is_not_0() -> None:
    grid = torch.zeros(3, BINS, 6, 6)
    grid[0, :, :2], grid[1, 0, 0] = torch.randn(BINS, 2, 6) * 9 + 4, 2.0
    made = normalised(grid)
    assert made[0, :, :2].mean().abs() < 1e-5
    assert made[0, :, :2].var(correction=0).item() == pytest.approx(1, rel=1e-4)
    assert not made[0, :, 2:].any()
    assert not made[2].any()
    assert torch.isfinite(made).all()


def test_training_learns_and_goes_on_where_it_was_interrupted(tmp_path: Path) -> None:
    clips, budget = some_clips(), Budget(steps=70, batch=2)
    whole = trained(clips, budget, 1, tmp_path / "whole.pt")
    assert np.mean(whole.losses[-10:]) < 0.8 * np.mean(whole.losses[:5])
    with pytest.raises(IndexError):  # it breaks off at a clip that is not there, after the first 50 steps
        trained(_broken_after(clips, 55), budget, 1, tmp_path / "part.pt")
    saved = torch.load(tmp_path / "part.pt", weights_only=True)
    assert len(saved["losses"]) == 50
    resumed = trained(clips, budget, 1, tmp_path / "part.pt")
    assert resumed.losses == whole.losses
    for one, other in zip(whole.network.parameters(), resumed.network.parameters(), strict=True):
        assert torch.equal(one, other)


def _broken_after(clips: Clips, steps: int) -> Clips:
    class Broken:
        taken = 0

        def __len__(self) -> int:
            return len(clips.grids)

        def __getitem__(self, chosen: torch.Tensor) -> torch.Tensor:
            self.taken += 1
            if self.taken > steps:
                raise IndexError
            return clips.grids[chosen]

    return Clips(Broken(), clips.images, clips.events)  # type: ignore[arg-type]


def test_measures_have_their_closed_forms() -> None:
    rng = np.random.default_rng(1)
    image = rng.uniform(0, 1, (40, 50))
    assert measures.mse(image, image + 0.1) == pytest.approx(0.01)
    assert measures.ssim(image, image) == pytest.approx(1)
    one, two = np.full((40, 50), 0.2), np.full((40, 50), 0.6)
    # of flat images only the means differ: (2 a b + C1) / (a^2 + b^2 + C1), C1 = 0.01^2
    assert measures.ssim(one, two) == pytest.approx((0.24 + 1e-4) / (0.4 + 1e-4))
    assert measures.ssim(image, rng.uniform(0, 1, (40, 50))) < 0.2


def test_equalising_leaves_only_the_order_of_light() -> None:
    image = np.random.default_rng(1).uniform(0, 1, (40, 50))
    even = measures.equalised(image)
    np.testing.assert_allclose(even, measures.equalised(3 * image**2 + 7))
    np.testing.assert_allclose(np.sort(even.ravel()), (np.arange(2000) + 0.5) / 2000)
    assert (measures.equalised(np.full((3, 3), 5.0)) == 0.5).all()


def test_windows_of_a_recording_end_at_its_frames(data: Path) -> None:
    (recording,) = real.recordings(data)
    counted = recording.frames[recording.counted :]
    # of the last 40 %, with ten windows at least before them for the memory to settle
    np.testing.assert_allclose(counted, frames()[11:] / 255)
    assert recording.grids.shape == (13, BINS, 24, 36)
    same = real.measured(recording.frames, recording)
    assert (same.mse, same.ssim) == (0, pytest.approx(1))


@pytest.mark.parametrize("name", MODELS + ABLATIONS)
def test_every_contender_gives_events_by_its_seed(name: str) -> None:
    def events(seed: int) -> np.ndarray:
        model = sensor_of(name)(36, 24, 1.0, np.random.default_rng(seed))
        return np.concatenate([model.advance(image, 40_000 * i) for i, image in enumerate(frames())])

    assert len(events(1)) > 100
    np.testing.assert_array_equal(events(1), events(1))


def test_models_are_set_apart_only_where_all_seeds_are() -> None:
    def run(model: str, mse: float, ssim: float) -> Run:
        return Run(model, 0, {}, 0, 0.0, [], {"r": {"mse": mse, "ssim": ssim}})

    found = [run("a", 1, 5), run("a", 2, 6), run("b", 3, 5.5), run("b", 4, 9)]
    assert separated(found, "a", "b", "r", "mse")
    assert not separated(found, "b", "a", "r", "mse")
    assert not separated(found, "b", "a", "r", "ssim")
    assert ahead_by_seed(found, "b", "a", "r", "ssim")
    assert not ahead_by_seed(found, "a", "b", "r", "ssim")


def test_the_command_writes_its_page_and_repeats_nothing(
    data: Path, photographs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, work = tmp_path / "study.md", tmp_path / "work"
    small = ["--clips", "2", "--size", "16", "--steps", "2", "--seeds", "1"]
    command = [
        "study",
        "--photographs",
        str(photographs),
        "--data",
        str(data),
        "--work",
        str(work),
        "--page",
        str(page),
    ]
    monkeypatch.setattr("sys.argv", [*command, *small])
    assert study.main() == 0
    assert [run.model for run in runs(work)] == list(MODELS)
    text = page.read_text()
    for name in MODELS:
        assert f"| {name} | 0 | " in text
    for figure in ("scores", "images", "losses"):
        assert (tmp_path / "study" / f"{figure}.png").stat().st_size > 1000
    result = folder_of(work, OURS) / "seed_0.json"
    kept = json.loads(result.read_text()) | {"seed": 5}
    result.write_text(json.dumps(kept))
    assert study.main() == 0
    assert json.loads(result.read_text()) == kept


def test_without_recordings_it_says_so(
    photographs: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["study", "--photographs", str(photographs), "--data", str(photographs)])
    with pytest.raises(SystemExit):
        study.main()
    assert "give --data, or VOLTCAM_DATA" in capsys.readouterr().err
