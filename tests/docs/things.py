"""Small things that pages speak of as if they were there: videos, recordings, images, camera files."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from tests.docs.blocks import DOCS, blocks

from voltcam_client.formats import open_writer
from voltcam_simulator import Camera, Parameters, Simulator

WIDTH, HEIGHT, FRAMES, PERIOD_US = 64, 48, 12, 40_000


def images(width: int = WIDTH, height: int = HEIGHT) -> NDArray[np.uint8]:
    """A bar that moves, (N, height, width)."""
    frames = np.full((FRAMES, height, width), 60, np.uint8)
    for i, frame in enumerate(frames):
        frame[:, 3 * i : 3 * i + 10] = 180
    return frames


def video(path: Path) -> None:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 1e6 / PERIOD_US, (WIDTH, HEIGHT))
    for frame in images():
        writer.write(cv2.cvtColor(frame, cv2.COLOR_GRAY2BGR))
    writer.release()


def dataset(path: Path) -> None:
    """A folder as those of the Event Camera Dataset."""
    (path / "images").mkdir(parents=True)
    lines = []
    for i, frame in enumerate(images()):
        cv2.imwrite(str(path / "images" / f"{i:03}.png"), frame)
        lines.append(f"{i * PERIOD_US / 1e6:.6f} images/{i:03}.png\n")
    (path / "images.txt").write_text("".join(lines))


def recording(path: Path) -> None:
    """Events and frames, where the format holds them."""
    simulator = Simulator(WIDTH, HEIGHT, Parameters(), seed=1)
    with open_writer(path, width=WIDTH, height=HEIGHT) as writer:
        for i, frame in enumerate(images()):
            writer.events(simulator.advance(frame, i * PERIOD_US))
            writer.frame(frame, i * PERIOD_US)


def only_frames(path: Path) -> None:
    np.savez(path, frames=images(), t_us=PERIOD_US * np.arange(FRAMES))


def camera_file(path: Path) -> None:
    path.write_text(Camera(name="mine", width=WIDTH, height=HEIGHT).to_yaml())


def config_file(path: Path) -> None:
    path.write_text("camera: davis346\n")


def program_of_dv(path: Path) -> None:
    """The first block of the page on dv-processing, as it stands there."""
    page = DOCS / "how-to" / "dv-processing.md"
    path.write_text(next(block.text for block in blocks(page) if block.language == "python"))


def photographs(path: Path) -> None:
    path.mkdir(parents=True)
    rng = np.random.default_rng(1)
    for name in ("a.png", "b.png"):
        coarse = rng.integers(0, 255, (12, 16, 3), dtype=np.uint8)
        cv2.imwrite(str(path / name), cv2.resize(coarse, (320, 240), interpolation=cv2.INTER_CUBIC))


THINGS: dict[str, Callable[[Path], None]] = {
    "*.mp4": video,
    "frames.npz": only_frames,
    "*.npz": recording,
    "*.txt": recording,
    "*.csv": recording,
    "*.raw": recording,
    "*.aedat4": recording,
    "slider_depth": dataset,
    "photographs": photographs,
    "filter.py": program_of_dv,
    "voltcam.yaml": config_file,
    "robot.yaml": config_file,
    "*.yaml": camera_file,
}


def make(path: Path) -> bool:
    """Make what a page means by a name; False where it means nothing that can be made."""
    for pattern, maker in THINGS.items():
        if path.match(pattern):
            path.parent.mkdir(parents=True, exist_ok=True)
            maker(path)
            return True
    return False
