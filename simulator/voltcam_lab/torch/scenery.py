"""What cameras look at: cut in time and space before anything is simulated."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import NDArray

from voltcam_video import Frame, SourceError, SourceRequest, Upsampling, between, open_source
from voltcam_video.photos import LAYERS, PhotoFolder, PhotoScene, light_of, smaller

Image = NDArray[np.uint8 | np.float32]


LONGEST = 1200  # side of a photograph that is kept [pixels]
MOST_KEPT = 32  # 4 bytes a pixel each


class Scenery(Protocol):
    """Where clips are cut from."""

    def clip(self, width: int, height: int, span_us: int, rng: np.random.Generator) -> Iterator[Frame]:
        """Frames of that size in order of time, the last `span_us` or more after the first.

        Raises ValueError or SourceError, a line that names what cannot be used.
        """
        ...


@dataclass
class Photographs:
    """A new scene from photographs for each clip, cut at a random place.

    photographs: a folder, of which the latest 32 are kept in memory, or a sequence of what
    `voltcam_video.photos.light_of` takes. width, height: of the
    scene, which is drawn only where a clip is cut from it. speed_px_s: the range from which its speed is
    drawn, log-uniform. fps: frames a second, between which light is interpolated.
    """

    photographs: Path | str | Sequence[NDArray[Any]]
    width: int = 346
    height: int = 260
    layers: int = LAYERS
    speed_px_s: tuple[float, float] = (30.0, 300.0)
    fps: float = 200.0

    def __post_init__(self) -> None:
        if isinstance(self.photographs, str | Path):
            self.photographs = _KeptLight(PhotoFolder(self.photographs), max(LONGEST, 3 * self.width))
        low, high = self.speed_px_s
        if not (0 < low <= high < math.inf):
            raise ValueError(f"speed_px_s takes a low and a high end above 0, not {low:g} and {high:g}")
        if not 0 < self.fps <= 10_000:
            raise ValueError(f"fps is above 0 and at most 10000, not {self.fps:g}")

    def clip(self, width: int, height: int, span_us: int, rng: np.random.Generator) -> Iterator[Frame]:
        if width > self.width or height > self.height:
            raise ValueError(
                f"a clip of {width} x {height} is larger than a scene of {self.width} x {self.height}"
            )
        speed_px_s = math.exp(rng.uniform(*np.log(self.speed_px_s)))
        assert not isinstance(self.photographs, str | Path)
        scene = PhotoScene(
            self.photographs,
            self.width,
            self.height,
            layers=self.layers,
            speed_px_s=speed_px_s,
            seed=int(rng.integers(2**63)),
            crop=(
                int(rng.integers(self.width - width + 1)),
                int(rng.integers(self.height - height + 1)),
                width,
                height,
            ),
        )
        steps = math.ceil(span_us * self.fps / 1e6)
        for step in range(steps + 1):
            t_us = round(step * span_us / steps)
            yield Frame(scene.frame(t_us), t_us)


class _KeptLight(Sequence[NDArray[np.float32]]):
    """The light of photographs, no finer than scenes need it; those of late are kept."""

    def __init__(self, photographs: PhotoFolder, longest: int) -> None:
        self._photographs, self._longest = photographs, longest
        self._kept: dict[int, NDArray[np.float32]] = {}

    def __len__(self) -> int:
        return len(self._photographs)

    @overload
    def __getitem__(self, index: int) -> NDArray[np.float32]: ...
    @overload
    def __getitem__(self, index: slice) -> list[NDArray[np.float32]]: ...
    def __getitem__(self, index: int | slice) -> NDArray[np.float32] | list[NDArray[np.float32]]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        light = self._kept.pop(index, None)
        if light is None:
            light = smaller(light_of(self._photographs[index]), self._longest)
        self._kept[index] = light
        if len(self._kept) > MOST_KEPT:
            del self._kept[next(iter(self._kept))]
        return light


@dataclass
class Videos:
    """Pieces of videos, image folders or `.npz`, at a random time and a random place.

    uris: as `voltcam convert` takes them. upsample: light between frames. Frames smaller than a clip are
    refused; larger ones are cut, not shrunk. What comes before a clip is read, and not simulated.
    """

    uris: Sequence[str | Path]
    upsample: Upsampling = "linear"

    def clip(self, width: int, height: int, span_us: int, rng: np.random.Generator) -> Iterator[Frame]:
        uri = str(self.uris[int(rng.integers(len(self.uris)))])
        request = SourceRequest(uri=uri, pace="fast")
        with open_source(request) as source:
            granted = source.granted
            if granted["width"] < width or granted["height"] < height:
                raise SourceError(
                    f"{uri}: its frames are {granted['width']} x {granted['height']}, smaller than a clip of "
                    f"{width} x {height}: make clips smaller"
                )
            left = int(rng.integers(granted["width"] - width + 1))
            top = int(rng.integers(granted["height"] - height + 1))
            length_s = ((granted["frames"] or 0) - 1) / (granted["fps"] or math.inf)
        room_s = length_s - span_us * 1e-6
        # half a frame for containers whose length is only estimated
        start_s = float(rng.uniform(0, room_s)) if room_s > 0 else 0.0
        yield from between(self._cut(request, start_s, span_us, (left, top, width, height)), self.upsample)

    @staticmethod
    def _cut(
        request: SourceRequest, start_s: float, span_us: int, place: tuple[int, int, int, int]
    ) -> Iterator[Frame]:
        left, top, width, height = place
        first_us: int | None = None
        with open_source(request.model_copy(update={"start_s": start_s})) as source:
            for frame in source:
                first_us = frame.t_us if first_us is None else first_us
                image = np.ascontiguousarray(frame.image[top : top + height, left : left + width])
                yield Frame(image, frame.t_us, gamma=frame.gamma)
                if frame.t_us >= first_us + span_us:
                    return
        raise SourceError(f"{request.shown}: shorter than a clip of {span_us * 1e-6:g} s: make clips shorter")
