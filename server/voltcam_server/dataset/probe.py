"""A look at every input before hours are spent: can it be read, are its sizes one, do its labels match."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from PIL import Image

from voltcam_client.formats.image_list import IMAGE_LIST, read_image_list
from voltcam_video import SourceError
from voltcam_video.sources.timed_images import images_in

from ..problems import one_line
from .clips import InputClip
from .item import ClipError
from .labels import BesideError, check_labels
from .tables import check_table

SIDE = 64  # pixels: of a scene, which has the size that one asks for


@dataclass(frozen=True)
class Probed:
    """frames: as far as is known without reading all. problem: why it gives no item; empty: it may."""

    clip: InputClip
    frames: int
    problem: str = ""


def probed(clips: Iterable[InputClip], seconds: float | None) -> Iterator[Probed]:
    """Each clip looked at; of scenes of the same photographs, the first. seconds: that are wanted of each."""
    scenes: dict[tuple[Path, float | None, str], Probed] = {}
    for clip in clips:
        # All but the seed, which comes first.
        kind = (clip.path, clip.fps, (clip.scene or "").partition("&")[2])
        if clip.scene is not None and kind in scenes:
            yield replace(scenes[kind], clip=clip)
            continue
        try:
            one = Probed(clip, _look(clip, seconds))
        except (SourceError, ClipError, BesideError, OSError, ValueError) as error:
            one = Probed(clip, 0, one_line(error))
        if clip.scene is not None:
            scenes[kind] = one
        yield one


def _look(clip: InputClip, seconds: float | None) -> int:
    """How many frames are wanted of it. Raises what `probed` tells."""
    if clip.path.is_dir() and clip.scene is None:
        _one_size(clip.path)
    with clip.open(SIDE, SIDE) as source:
        granted = source.granted
        endless = source.endless
    if endless:
        assert seconds is not None
        return int(seconds * (granted["fps"] or 0)) + 1
    frames = granted["frames"]
    if frames == 1:
        raise ClipError(f"{clip.path} has one frame: events need two, give a longer one")
    if clip.labels is not None:
        exact = frames
        if frames is not None and granted["kind"] == "file" and _count_differs(clip.labels, frames):
            exact = _counted(clip)  # containers may announce what is not there
        check_labels(clip.labels, exact, (granted["width"], granted["height"]))
    if clip.table is not None:
        check_table(clip.table, frames)
    if frames is None:
        return 0
    wanted = frames if seconds is None or granted["fps"] is None else int(seconds * granted["fps"]) + 1
    return min(frames, wanted)


def _one_size(folder: Path) -> None:
    """Raises ClipError for a folder with images of several sizes; what is no image its source tells."""
    listed = folder / IMAGE_LIST
    paths = [one.path for one in read_image_list(listed)] if listed.exists() else images_in(folder)
    first: tuple[Path, tuple[int, int]] | None = None
    for path in paths:
        try:
            with Image.open(path) as image:
                size = image.size
        except OSError:
            continue
        if first is None:
            first = path, size
        elif size != first[1]:
            raise ClipError(
                f"{path} has {size[0]}x{size[1]} pixels, {first[0].name} {first[1][0]}x{first[1][1]}: make "
                "all of one size"
            )


def _count_differs(labels: Path, frames: int) -> bool:
    return not (labels / IMAGE_LIST).exists() and len(images_in(labels)) != frames


def _counted(clip: InputClip) -> int:
    with clip.open(SIDE, SIDE) as source:
        return sum(1 for _ in source)
