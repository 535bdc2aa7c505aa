"""Frames with label images, at small size."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install 'voltcam[learn]'")

from voltcam_client.formats import open_writer  # noqa: E402
from voltcam_simulator import Parameters, Simulator  # noqa: E402

from . import __main__ as study  # noqa: E402
from . import labelled  # noqa: E402
from .clips import WINDOWS  # noqa: E402
from .contenders import MODELS  # noqa: E402
from .network import FireNet  # noqa: E402

WIDTH, HEIGHT, COUNT = 36, 24, WINDOWS + 2


def folder_at(path: Path, *, events: bool) -> Path:
    """A bright square, class 1, that moves over class 0; the first row is not counted."""
    (path / "images").mkdir(parents=True)
    (path / "labels").mkdir()
    frames, lines = [], []
    for i in range(COUNT):
        image, label = np.full((HEIGHT, WIDTH), 60, np.uint8), np.zeros((HEIGHT, WIDTH), np.uint8)
        image[6:18, 2 * i : 2 * i + 8], label[6:18, 2 * i : 2 * i + 8], label[0] = 200, 1, 255
        cv2.imwrite(str(path / "images" / f"{i}.png"), image)
        cv2.imwrite(str(path / "labels" / f"{i}.png"), label)
        lines.append(f"{i * 0.04:.6f} images/{i}.png\n")
        frames.append(image)
    (path / "images.txt").write_text("".join(lines))
    if events:
        simulator = Simulator(WIDTH, HEIGHT, Parameters.of("davis240c"), seed=1)
        with open_writer(path / "events.txt", width=WIDTH, height=HEIGHT) as writer:
            for i, image in enumerate(frames):
                writer.events(simulator.advance(image, 40_000 * i))
    return path


def test_labels_come_with_their_frames_and_frames_as_light(tmp_path: Path) -> None:
    coded = labelled.read(folder_at(tmp_path / "a", events=False))
    light = labelled.read(folder_at(tmp_path / "b", events=True))
    assert coded.labels.shape == coded.frames.shape == (COUNT, HEIGHT, WIDTH)
    assert (coded.classes, coded.footage) == (2, None)
    assert light.footage is not None
    assert light.frames.max() == 200  # a DAVIS's own frames
    assert coded.frames.max() == pytest.approx(255 * (200 / 255) ** 2.2, rel=1e-4)
    np.testing.assert_array_equal(coded.labels[3] == 1, coded.frames[3] > 100)


def test_clips_keep_grids_and_labels_together(tmp_path: Path) -> None:
    labels = labelled.read(folder_at(tmp_path, events=False)).labels
    grids = np.repeat(labels[1:, None].astype(np.float32), 5, axis=1)  # a grid that shows its label
    clips = labelled.clips_of(grids, labels, 6, 16, seed=1)
    assert clips.grids.shape == (6, WINDOWS, 5, 16, 16)
    assert torch.equal(clips.grids[:, :, 0], clips.images.half())
    with pytest.raises(ValueError, match="too few or too small"):
        labelled.clips_of(grids, labels, 6, 30, seed=1)


def test_the_measure_has_its_closed_form() -> None:
    class Says(FireNet):
        """Class 1 in the left half."""

        def forward(self, grid: torch.Tensor, state: object = None) -> object:  # type: ignore[override]
            made = torch.zeros(1, 2, 4, 8)
            made[:, 1, :, :4] = made[:, 0, :, 4:] = 1
            return made, state

    labels = np.zeros((2, 4, 8), np.uint8)
    labels[1, :, :2], labels[1, 0] = 1, 255
    seen = labelled.Labelled(np.zeros((2, 4, 8), np.float32), np.arange(2), labels)
    # of 24 counted pixels: class 1 has 6 and is said of 12; class 0 has 18 and is said of 12
    union, right = labelled.intersection_over_union(Says(2), np.zeros((1, 5, 4, 8), np.float32), seen)
    assert union == pytest.approx((6 / 12 + 12 / 18) / 2)
    assert right == pytest.approx(18 / 24)


def test_the_command_trains_on_labels_and_tests_on_real_events(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    train, test = folder_at(tmp_path / "train", events=False), folder_at(tmp_path / "test", events=True)
    small = ["--clips", "2", "--size", "16", "--steps", "2", "--seeds", "1", "--work", str(tmp_path / "work")]
    monkeypatch.setattr("sys.argv", ["study", "--labelled", str(train), "--labelled-test", str(test), *small])
    assert study.main() == 0
    lines = [json.loads(line) for line in (tmp_path / "work" / "segmentation.jsonl").read_text().splitlines()]
    assert [line["model"] for line in lines] == list(MODELS)
    assert all(0 <= line["mean_iou"] <= line["accuracy"] <= 1 for line in lines)
    assert "mean IoU" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda folder: (folder / "labels" / "3.png").unlink(), "3.png: no label image of 8 bit"),
        (
            lambda folder: cv2.imwrite(str(folder / "labels" / "3.png"), np.zeros((5, 5), np.uint8)),
            "make them of one size",
        ),
        (lambda folder: (folder / "images.txt").unlink(), "no images.txt"),
    ],
)
def test_labels_that_do_not_match_are_said_before_anything_is_simulated(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    spoil: object,
    says: str,
) -> None:
    train, test = folder_at(tmp_path / "train", events=False), folder_at(tmp_path / "test", events=True)
    spoil(train)  # type: ignore[operator]
    monkeypatch.setattr("sys.argv", ["study", "--labelled", str(train), "--labelled-test", str(test)])
    assert study.main() == 1
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1


def test_a_test_without_events_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    train = folder_at(tmp_path / "train", events=False)
    for arguments in (["--labelled-test", str(train)], []):
        monkeypatch.setattr("sys.argv", ["study", "--labelled", str(train), *arguments])
        assert study.main() == 1
        assert "real camera's events" in capsys.readouterr().err
