"""Small inputs, and an engine in this process."""

import threading
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from voltcam_server.dataset.clips import Item
from voltcam_server.dataset.engines import Engine, Work
from voltcam_server.dataset.item import ItemOutcome
from voltcam_server.dataset.make import Made, make_set
from voltcam_server.dataset.spec import Spec, spec_of

WIDTH, HEIGHT, FRAMES, PERIOD_US = 24, 16, 6, 10_000


def images(seed: int = 0, count: int = FRAMES, width: int = WIDTH, height: int = HEIGHT) -> Any:
    """A bar that moves, (count, height, width) uint8; the seed says where it begins."""
    frames = np.full((count, height, width), 60, np.uint8)
    for i, frame in enumerate(frames):
        frame[:, (2 * i + seed) % (width - 4) :][:, :4] = 200
    return frames


def clip(path: Path, seed: int = 0, count: int = FRAMES) -> Path:
    """An .npz of frames."""
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez(path, frames=images(seed, count), t_us=PERIOD_US * np.arange(count))
    return path


def clips(folder: Path, count: int) -> Path:
    for number in range(count):
        clip(folder / f"clip{number}.npz", number)
    return folder


def image_folder(folder: Path, count: int = FRAMES, suffix: str = ".png") -> Path:
    """Images without times, named 0, 1, ... 10."""
    folder.mkdir(parents=True)
    for number, image in enumerate(images(count=count)):
        Image.fromarray(image).save(folder / f"{number}{suffix}")
    return folder


def camera(folder: Path) -> str:
    """A camera file of the clips' size."""
    path = folder / "tiny.yaml"
    path.write_text(f"name: tiny\nwidth: {WIDTH}\nheight: {HEIGHT}\n")
    return str(path)


def spec(folder: Path, inputs: Any, **given: Any) -> Spec:
    return spec_of({"inputs": inputs, "camera": camera(folder)} | given, "test")


class HereEngine(Engine):
    """Makes items in this process. stop_after: so many, as Ctrl-C does."""

    def __init__(self, stop_after: int | None = None, reverse: bool = False) -> None:
        self.stop_after, self.reverse = stop_after, reverse
        self.done: list[str] = []

    @property
    def workers(self) -> int:
        return 1

    def check(self, folder: Path) -> None: ...

    def run(self, work: Work, items: Iterable[Item], stop: threading.Event) -> Iterator[ItemOutcome]:
        for item in reversed(list(items)) if self.reverse else items:
            if stop.is_set():
                return
            self.done.append(item.path)
            yield work(item)
            if self.stop_after is not None and len(self.done) >= self.stop_after:
                stop.set()

    def close(self) -> None: ...


def made(spec: Spec, out: Path, engine: Engine | None = None) -> Made:
    """A set, made here."""
    here = engine or HereEngine()
    return make_set(spec, out, lambda: here)


def content(folder: Path) -> dict[str, bytes]:
    """All files of a set."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
