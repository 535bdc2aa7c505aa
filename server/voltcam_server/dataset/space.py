"""How much of the disk a set will take: a few frames of a few clips are simulated to know."""

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from voltcam_client.encodings import EVENT
from voltcam_video import SourceError

from ..problems import UsageError
from .clips import Item
from .item import ClipError, Making, camera_of, simulate

SAMPLES, SAMPLE_FRAMES = 3, 12
EVENT_BYTES = {".h5": 5.5, ".npz": 13.0, ".aedat4": 16.0}
FRAME_BYTES = {".h5": 0.8, ".npz": 1.0, ".aedat4": 1.0}  # of a pixel


@dataclass(frozen=True)
class DiskSpace:
    """Bytes. set_bytes: of all items. worker_bytes: what one takes beside, while it is made."""

    set_bytes: float
    worker_bytes: float

    def check(self, folder: Path, workers: int) -> None:
        """Raises UsageError where the disk has less."""
        needed, free = self.set_bytes + workers * self.worker_bytes, shutil.disk_usage(folder).free
        if needed > free:
            raise UsageError(
                f"{folder}: the set takes about {in_words(needed)}, and {in_words(free)} are free: make "
                "room, give another folder, or leave frames out (frames: false)"
            )


def space_for(items: Sequence[Item], frames: Sequence[int], making: Making) -> DiskSpace:
    """frames: of each item. From SAMPLES of them, spread over all; what cannot be simulated says nothing."""
    events, pixels = list[float](), 1
    for item in items[:: max(1, len(items) // SAMPLES)][:SAMPLES]:
        camera = camera_of(item, making.cameras)
        pixels = max(pixels, camera.width * camera.height)
        try:
            with item.clip.open(camera.width, camera.height) as source:
                steps = simulate(item, making, source, camera, lambda *_: None, SAMPLE_FRAMES)
                events.append(sum(len(one) for one in steps) / SAMPLE_FRAMES)
        except (SourceError, ClipError, ValueError):
            continue
    a_frame = max(events, default=0.0)
    suffix = Path(items[0].path).suffix
    kept = pixels * FRAME_BYTES[suffix] if making.frames else 0.0
    spooled = EVENT.itemsize * a_frame + (pixels if making.frames else 0)
    return DiskSpace(sum(frames) * (a_frame * EVENT_BYTES[suffix] + kept), max(frames, default=0) * spooled)


def in_words(size: float) -> str:
    """In megabytes or gigabytes."""
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"
