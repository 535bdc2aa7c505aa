"""One item of a data set: a clip simulated into a file, written aside and renamed when all of it is there."""

import errno
import hashlib
import shutil
import tempfile
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import Events
from voltcam_client.formats import FormatError, Writer, open_writer
from voltcam_lab.drawn_camera import CameraDistribution
from voltcam_simulator import Camera, Device, Law, NoDeviceError, Simulator
from voltcam_video import Fit, Frame, Image, Source, SourceError, Upsampling, between, fit
from voltcam_video.sources.photos import PhotosSource

from ..ground_truth import GroundTruthWriter
from ..manifest import software
from ..problems import one_line
from .clips import Item
from .labels import BesideError, label_images, write_labels
from .tables import write_table

ASIDE = ".aside"  # folder of the set in which items are made
CAMERA_STREAM = 1  # of an item's random numbers: the simulator has the seed itself


class ClipError(ValueError):
    """One line: why a clip gives no item, and the remedy."""


@dataclass(frozen=True)
class Making:
    """What all items of a set have in common. out: its folder."""

    out: Path
    cameras: CameraDistribution
    law: Law
    device: Device
    upsample: Upsampling
    fit: Fit
    seconds: float | None
    frames: bool


@dataclass(frozen=True)
class ItemOutcome:
    """record: its line in the manifest. full: the disk is, so that no other will do better."""

    item: Item
    record: dict[str, Any]
    full: bool = False

    @property
    def failed(self) -> str | None:
        """Why there is no item."""
        reason: str | None = self.record.get("failed")
        return reason


def make_item(item: Item, making: Making) -> ItemOutcome:
    """Make it; what goes wrong with it is in its outcome."""
    try:
        return ItemOutcome(item, _made(item, making))
    except (SourceError, BesideError, ClipError, FormatError, NoDeviceError, ValueError) as error:
        return failure(item, one_line(error))
    except OSError as error:
        full = _errno(error) in (errno.ENOSPC, errno.EDQUOT)
        return failure(item, one_line(error), full=full)
    except MemoryError:
        return failure(item, "there was not memory enough: give fewer --workers")


def failure(item: Item, reason: str, *, full: bool = False) -> ItemOutcome:
    """The outcome of an item that there is not."""
    line = {"name": item.clip.name, "variant": item.variant, "failed": reason, "digest": item.digest}
    return ItemOutcome(item, line, full)


def camera_of(item: Item, cameras: CameraDistribution) -> Camera:
    """The one that is drawn for it."""
    return cameras.draw(np.random.default_rng([item.seed, CAMERA_STREAM]))


def simulate(
    item: Item,
    making: Making,
    source: Source,
    camera: Camera,
    look: Callable[[Image, int], None],
    most_frames: int | None = None,
) -> Iterator[Events]:
    """The events of its frames; `look` gets each frame, as the sensor sees it, when its events are there.

    Raises SourceError, ClipError, and what the simulator does.
    """
    simulator = Simulator(
        camera.width,
        camera.height,
        camera.parameters.seen_through(source.gamma),
        making.law,
        item.seed,
        threads=1,  # a process has a core; the same events with any number
        device=making.device,
    )
    pending: deque[Frame] = deque()
    frames = _fitted(source, making, camera, pending, most_frames)
    for step in between(frames, making.upsample):
        yield simulator.advance(step.image, step.t_us)
        while pending and pending[0].t_us <= step.t_us:
            seen = pending.popleft()
            look(seen.image, seen.t_us)


def _fitted(
    source: Source, making: Making, camera: Camera, pending: deque[Frame], most_frames: int | None
) -> Iterator[Frame]:
    first: Frame | None = None
    last_us, count = 0, 0
    for frame in source:
        if first is None:
            first = frame
        elif frame.t_us <= last_us:
            raise ClipError(f"frame {count}: {frame.t_us} us is not after the one before: sort them by time")
        if frame.image.shape != first.image.shape:
            raise ClipError(
                f"frame {count} has {_size(frame.image)} pixels, those before {_size(first.image)}: "
                "make all of one size"
            )
        long = making.seconds is not None and frame.t_us - first.t_us > making.seconds * 1e6
        if long or (most_frames is not None and count >= most_frames):
            break
        fitted = replace(frame, image=fit(frame.image, camera.width, camera.height, making.fit))
        pending.append(fitted)
        yield fitted
        last_us, count = frame.t_us, count + 1
    if count < 2:
        raise ClipError(f"it has {count} frame{'s' * (count != 1)}: events need two, give a longer one")


def _size(image: Image) -> str:
    return f"{image.shape[1]}x{image.shape[0]}"


def _made(item: Item, making: Making) -> dict[str, Any]:
    aside = making.out / ASIDE
    aside.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(dir=aside))
    try:
        files, counts = _written(item, making, folder / Path(item.path).name)
        target = making.out / item.path
        target.parent.mkdir(parents=True, exist_ok=True)
        sums = {}
        for file in reversed(files):  # the events last: where they are, all is
            place = target.parent / file.name
            sums[str(place.relative_to(making.out))] = _sha256(file)
            file.replace(place)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    size = sum((making.out / path).stat().st_size for path in sums)
    return counts | {"bytes": size, "sha256": dict(sorted(sums.items())), "software": _software()}


def _written(item: Item, making: Making, path: Path) -> tuple[list[Path], dict[str, Any]]:
    """The files, that of the events first, and what the manifest says of them."""
    camera = camera_of(item, making.cameras)
    size = (camera.width, camera.height)
    taken_us, on, files = list[int](), 0, [path]
    with ExitStack() as opened:
        source = opened.enter_context(item.clip.open(*size))
        writer = opened.enter_context(open_writer(path, width=size[0], height=size[1]))
        truth: GroundTruthWriter | None = None
        if item.clip.truth and isinstance(source, PhotosSource):
            files.append(path.with_name(f"{path.name}.truth.h5"))
            truth = opened.enter_context(GroundTruthWriter(files[-1], source.scene, item.clip.name))

        def look(image: Image, t_us: int) -> None:
            taken_us.append(t_us)
            if making.frames:
                writer.frame(as_u8(image), t_us)
            if truth is not None:
                truth.frame(image, t_us)

        for events in simulate(item, making, source, camera, look):
            writer.events(events)
            on += int(np.count_nonzero(events["p"]))
    if item.clip.labels is not None:
        files.append(path.with_name(f"{path.name}.labels.npz"))
        write_labels(files[-1], label_images(item.clip.labels).at(taken_us), size, making.fit)
    if item.clip.table is not None:
        files.append(path.with_name(f"{path.name}.table.csv"))
        write_table(item.clip.table, files[-1], taken_us)
    return files, _record(item, making, source, camera, writer, on, taken_us)


def _record(
    item: Item,
    making: Making,
    source: Source,
    camera: Camera,
    writer: Writer,
    on: int,
    taken_us: list[int],
) -> dict[str, Any]:
    seconds = (taken_us[-1] - taken_us[0]) / 1e6
    return {
        "name": item.clip.name,
        "variant": item.variant,
        "path": item.path,
        "digest": item.digest,
        "source": str(item.clip.path),
        "source_width": source.granted["width"],
        "source_height": source.granted["height"],
        "levels": source.levels,
        "seed": item.seed,
        "camera": camera.name,
        "width": camera.width,
        "height": camera.height,
        "drawn": {name: _value(camera, name) for name in making.cameras.varied},
        "parameters": camera.parameters.model_dump(exclude_defaults=True),
        "frames": len(taken_us),
        "begin_us": taken_us[0],
        "seconds": seconds,
        "events": writer.event_count,
        "on": on,
        "events_per_s": writer.event_count / seconds,
    }


def _value(camera: Camera, name: str) -> Any:
    effect, _, own = name.partition(".")
    value = getattr(camera.parameters, effect)
    return getattr(value, own) if own else value


def as_u8(image: Image) -> NDArray[np.uint8]:
    """A frame as recordings hold it."""
    if image.dtype == np.uint8:
        return image.astype(np.uint8, copy=False)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@cache
def _software() -> dict[str, str]:
    return software()


def _errno(error: BaseException | None) -> int | None:
    """Of an error, or of the one that it was made from."""
    while error is not None:
        if isinstance(error, OSError) and error.errno is not None:
            return error.errno
        error = error.__cause__
    return None
