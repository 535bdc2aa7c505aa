"""What `voltcam convert --truth` writes beside the events."""

from pathlib import Path

import cv2
import h5py
import numpy as np
import pytest

from voltcam_client.formats import read
from voltcam_server.convert import Conversion, convert
from voltcam_server.problems import UsageError
from voltcam_simulator import Simulator
from voltcam_video import SourceRequest
from voltcam_video.photos import PhotoFolder, PhotoScene

from .rig import moving_frames, save_frames, tiny

FPS = 50.0


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "photographs"
    folder.mkdir()
    rng = np.random.default_rng(1)
    for name in ("a.png", "b.png"):
        coarse = rng.integers(0, 255, (6, 8, 3), dtype=np.uint8)
        cv2.imwrite(str(folder / name), cv2.resize(coarse, (80, 60), interpolation=cv2.INTER_CUBIC))
    return folder


def job(source: str, output: Path, truth: Path | None) -> Conversion:
    request = SourceRequest(uri=source, pace="fast", fps=FPS)
    return Conversion(request, tiny(), output, seed=2, upsample="linear", seconds=0.1, truth=truth)


def test_light_flow_and_order_lie_beside_the_events(folder: Path, tmp_path: Path) -> None:
    output, truth = tmp_path / "out.npz", tmp_path / "truth.h5"
    convert(job(f"photos:{folder}?seed=4", output, truth))
    camera = tiny()
    scene = PhotoScene(PhotoFolder(folder), camera.width, camera.height, seed=4)
    simulator = Simulator(camera.width, camera.height, camera.parameters, seed=2)
    with h5py.File(truth) as file:
        assert file["t_us"][:].tolist() == [round(i * 1e6 / FPS) for i in range(6)]
        assert (file.attrs["width"], file.attrs["height"]) == (camera.width, camera.height)
        for i, t_us in enumerate(file["t_us"][:].tolist()):
            for name, expected in (
                ("light", scene.frame(t_us)),
                ("flow", scene.flow(t_us)),
                ("order", scene.order(t_us)),
                ("homographies", scene.homographies(t_us)),
            ):
                np.testing.assert_array_equal(file[name][i], expected)
        events = [
            simulator.advance(*each) for each in zip(file["light"], file["t_us"][:].tolist(), strict=True)
        ]
    np.testing.assert_array_equal(read(output).events, np.concatenate(events))


def test_only_what_is_made_of_photographs_has_it(tmp_path: Path) -> None:
    frames = save_frames(tmp_path / "in.npz", moving_frames(3, tiny()))
    with pytest.raises(UsageError, match="known of photos:FOLDER only"):
        convert(job(str(frames), tmp_path / "out.npz", tmp_path / "truth.h5"))
    assert not (tmp_path / "out.npz").exists()


def test_an_old_one_is_kept_unless_it_may_be_replaced(folder: Path, tmp_path: Path) -> None:
    truth = tmp_path / "truth.h5"
    truth.write_text("mine")
    with pytest.raises(UsageError, match="or --overwrite"):
        convert(job(f"photos:{folder}", tmp_path / "out.npz", truth))
    assert truth.read_text() == "mine"


def test_where_it_cannot_be_written_it_is_said(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"none/truth\.h5: "):
        convert(job(f"photos:{folder}", tmp_path / "out.npz", tmp_path / "none" / "truth.h5"))
