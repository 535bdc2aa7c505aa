"""Photographs in a folder as planes that move: `photos:FOLDER?seed=1&layers=4&speed=100`."""

import math
import threading
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from urllib.parse import parse_qsl

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.photos import LAYERS, SPEED_PX_S, PhotoFolder, PhotoScene
from voltcam_video.request import SourceRequest
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted, SourceError

WIDTH, HEIGHT, FPS = 346, 260, 60.0
MOST_PIXELS = 4096 * 4096
OPTIONS = {"seed": 0, "layers": LAYERS, "speed": SPEED_PX_S}


class PhotosSource(RecordedSource):
    """A `PhotoScene` at `width`, `height` and `fps` of the request; it does not end.

    scene: what is seen, with its flow and order.
    """

    endless = True

    def __init__(self, request: SourceRequest, clock: Clock, stop: threading.Event) -> None:
        # As the built-in scene, it begins where it is to begin at once.
        super().__init__(request.model_copy(update={"start_s": 0.0}), clock, stop)
        self.request = request
        width, height = request.width or WIDTH, request.height or HEIGHT
        if request.levels == "video":
            raise SourceError(f"{request.shown}: its frames are light; leave --levels video away")
        seed, layers, speed_px_s = _options(request)
        if width * height * layers > MOST_PIXELS:
            raise SourceError(
                f"a scene of {width} x {height} in {layers} layers is too large: "
                f"give at most {MOST_PIXELS} pixels in all"
            )
        try:
            photographs = PhotoFolder(request.photo_folder or Path())
            self.scene = PhotoScene(
                photographs, width, height, layers=layers, speed_px_s=speed_px_s, seed=seed
            )
        except (OSError, ValueError) as error:
            raise SourceError(str(error)) from None
        self._fps = request.fps or FPS
        self.granted = Granted(
            kind="photos",
            live=False,
            width=width,
            height=height,
            fps=self._fps,
            pixel_format=None,
            frames=None,
            backend=None,
            clock="recording",
            levels=self.levels,
        )

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.photo_folder is not None

    def _take(self) -> Iterator[Frame]:
        for i in count(math.ceil(self.request.start_s * self._fps)):
            t_us = round(i * 1e6 / self._fps)
            yield Frame(self.scene.frame(t_us), t_us, gamma=self.gamma)


def _options(request: SourceRequest) -> tuple[int, int, float]:
    """Seed, layers and speed. Raises SourceError."""
    given = parse_qsl(request.photo_options, keep_blank_values=True)
    for name, _ in given:
        if name not in OPTIONS:
            raise SourceError(f"{request.shown}: there is no option {name!r}; there are {', '.join(OPTIONS)}")
    said = {name: str(default) for name, default in OPTIONS.items()} | dict(given)
    try:
        seed = int(said["seed"])
        if seed < 0:
            raise ValueError
        return seed, int(said["layers"]), float(said["speed"])
    except ValueError:
        raise SourceError(
            f"{request.shown}: seed and layers are whole numbers from 0, speed is in pixels per second"
        ) from None
