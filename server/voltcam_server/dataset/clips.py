"""The inputs that a spec names, one by one: a clip is a video, an .npz or a folder of images."""

import glob
import hashlib
import re
import threading
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlencode

from voltcam_video import Levels, Source, SourceRequest, open_source
from voltcam_video.request import PHOTOS
from voltcam_video.sources.images import ImagesSource
from voltcam_video.sources.timed_images import Unit, evenly_timed, timed_by

from ..problems import UsageError
from .spec import Input, Spec

WILD = re.compile(r"[*?\[]")
UNSAFE = re.compile(r"[^\w.+=@-]+")  # in a file's name
LONGEST_NAME = 200  # bytes; endings come behind it


@dataclass(frozen=True)
class InputClip:
    """One input. name: its path below the fixed part of the pattern that found it, and what its seeds are
    made from. fps, stamps, unit: of a folder of images without a list. labels, table: beside it, or None.
    scene: the options of a scene that a folder's photographs make. truth: whether its flow goes along."""

    name: str
    path: Path
    levels: Levels = "auto"
    fps: float | None = None
    stamps: str | None = None
    unit: Unit = "s"
    labels: Path | None = None
    table: Path | None = None
    scene: str | None = None
    truth: bool = False

    def open(self, width: int, height: int) -> Source:
        """Its frames; those of a scene have the size of the sensor. Raises SourceError."""
        # A path with a folder before it: a folder "scene" is not the built-in one, a file "0" is no camera.
        uri = str(self.path) if self.path.is_absolute() else f"./{self.path}"
        if self.scene is not None:
            return open_source(
                SourceRequest(
                    uri=f"{PHOTOS}{uri}?{self.scene}", pace="fast", width=width, height=height, fps=self.fps
                ),
                stop=threading.Event(),
            )
        request = SourceRequest(uri=uri, pace="fast", levels=self.levels)
        if not self.path.is_dir() or (self.fps is None and self.stamps is None):
            return open_source(request, stop=threading.Event())
        if self.stamps is not None:
            listed = timed_by(self.path, self.path / self.stamps, self.unit)
        else:
            assert self.fps is not None
            listed = evenly_timed(self.path, self.fps)
        return ImagesSource(request, listed=listed)

    @property
    def settings(self) -> str:
        """What of it changes what is made, beside its frames."""
        beside = f"{self.labels is not None} {self.table is not None} {self.truth}"
        return f"{self.fps} {self.stamps} {self.unit} {self.scene} {beside}"


@dataclass(frozen=True)
class Item:
    """One file of the set: a clip as a camera of its own sees it. path: in the set. digest: of all that it is
    made with, its clip's content aside."""

    clip: InputClip
    variant: int
    seed: int
    path: str
    digest: str

    @property
    def key(self) -> tuple[str, int]:
        """What it is called in the manifest."""
        return self.clip.name, self.variant


def clips_of(spec: Spec) -> list[InputClip]:
    """In order of their names. Raises UsageError for a pattern that finds nothing, and for equal names."""
    clips = [clip for each in spec.inputs for clip in _found(each, spec)]
    names: dict[str, Path] = {}
    for clip in clips:
        if clip.name in names:
            raise UsageError(
                f"{clip.path} and {names[clip.name]} are both {clip.name}: give one of the inputs a `name`"
            )
        names[clip.name] = clip.path
    return sorted(clips, key=lambda clip: clip.name)


def items_of(spec: Spec, clips: list[InputClip]) -> list[Item]:
    """Variants of each clip. Raises UsageError where two would be in one file."""
    items, files = list[Item](), dict[str, str]()
    # Camera files by what is in them.
    same = f"{spec.model_dump_json(exclude={'inputs', 'variants', 'shard', 'camera'})} {spec.cameras()}"
    for clip in clips:
        stem = UNSAFE.sub("-", clip.name)
        if len(stem.encode()) > LONGEST_NAME:
            raise UsageError(f"{clip.name}: the name is too long for a file: rename the input")
        if stem in files:
            raise UsageError(f"{clip.name} and {files[stem]} would both be {stem}: give one input a `name`")
        files[stem] = clip.name
        for variant in range(spec.variants):
            folder = "items" if spec.shard is None else f"items/{len(items) // spec.shard:05}"
            items.append(
                Item(
                    clip,
                    variant,
                    seed_of(spec.seed, clip.name, variant),
                    f"{folder}/{stem}.{variant}{spec.format}",
                    hashlib.sha256(f"{same} {clip.settings}".encode()).hexdigest()[:16],
                )
            )
    return items


def seed_of(seed: int, name: str, variant: int) -> int:
    """Of an item, from its name: the same whatever else is in the set. 63 bits, as the simulator takes."""
    digest = hashlib.sha256(f"{seed}\n{variant}\n{name}".encode()).digest()
    return int.from_bytes(digest[:8], "big") >> 1


def _found(each: Input, spec: Spec) -> list[InputClip]:
    base = _fixed(each.files)
    paths = [Path(path) for path in sorted(glob.glob(each.files, recursive=True))]  # noqa: PTH207
    if not paths:
        raise UsageError(f"inputs: {each.files} finds nothing: correct the pattern, or fill the folder")
    if len(paths) == 1 and paths[0].is_dir() and not any(paths[0].iterdir()):
        raise UsageError(f"inputs: {paths[0]} is empty: fill the folder, or leave it out")
    if each.scenes is not None:
        return [
            _scene(each, path, base, spec.seed, number) for path in paths for number in range(each.scenes)
        ]
    return [_clip(each, path, base, spec.levels) for path in paths]


def _scene(each: Input, folder: Path, base: Path, seed: int, number: int) -> InputClip:
    """How it moves is the same for all variants of it: they differ in their cameras."""
    name = f"{each.name}/{folder.relative_to(base)}/scene-{number:06}".lstrip("/")
    given = {"layers": each.layers, "speed": each.speed}
    options = {"seed": seed_of(seed, name, -1)} | {key: value for key, value in given.items() if value}
    return InputClip(name, folder, fps=each.fps, scene=urlencode(options), truth=each.truth)


def _clip(each: Input, path: Path, base: Path, levels: Levels) -> InputClip:
    name = f"{each.name}/{path.relative_to(base)}".lstrip("/")
    places = {
        "stem": path.stem,
        "name": str(path.relative_to(base).with_suffix("")),
        "folder": str(path if path.is_dir() else path.parent),
    }
    folder = path.is_dir() and not (path / "images.txt").exists()
    return InputClip(
        name,
        path,
        levels,
        each.fps if folder else None,
        each.stamps if folder else None,
        each.stamps_unit,
        _beside(each.labels, places),
        _beside(each.table, places),
    )


def _beside(pattern: str | None, places: dict[str, str]) -> Path | None:
    if pattern is None:
        return None
    try:
        return Path(pattern.format(**places))
    except (LookupError, ValueError):
        raise UsageError(f"inputs: {pattern}: only {{stem}}, {{name}} and {{folder}} are known") from None


def _fixed(pattern: str) -> Path:
    """The folders that a pattern names without wild cards; of a path without any, the folder it is in."""
    parts = Path(pattern).parts
    wild = next((number for number, part in enumerate(parts) if WILD.search(part)), len(parts) - 1)
    return Path(*parts[:wild]) if wild else Path()
