"""A folder of images with a list of their times: the Event Camera Dataset's layout."""

import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

from voltcam_client.formats import FormatError
from voltcam_client.formats.image_list import IMAGE_LIST, ListedImage, read_image_list
from voltcam_video.clock import Clock
from voltcam_video.frame import Frame, Image, luminance
from voltcam_video.opencv import cv2
from voltcam_video.request import SourceRequest
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted, SourceError


class ImagesSource(RecordedSource):
    """The listed images, in the list's order and at its times; `listed`: where the folder has no list.

    Beside events they are a camera's own frames, which are light; by themselves, pictures coded for screens.
    """

    def __init__(
        self,
        request: SourceRequest,
        clock: Clock | None = None,
        stop: threading.Event | None = None,
        listed: Sequence[ListedImage] | None = None,
    ) -> None:
        super().__init__(request, clock or Clock(), stop or threading.Event())
        self._listed = _listed(Path(request.uri)) if listed is None else listed
        self.coded = not (Path(request.uri) / "events.txt").exists()
        height, width = _read_image(self._listed[0].path).shape
        span_us = self._listed[-1].t_us - self._listed[0].t_us
        self.granted = Granted(
            kind="images",
            live=False,
            width=width,
            height=height,
            fps=(len(self._listed) - 1) * 1e6 / span_us if span_us else None,
            pixel_format=None,
            frames=len(self._listed),
            backend=None,
            clock="recording",
            levels=self.levels,
        )

    @classmethod
    def reads(cls, request: SourceRequest) -> bool:
        return request.path is not None and request.path.is_dir()

    def _take(self) -> Iterator[Frame]:
        for image in self._listed:
            yield Frame(_read_image(image.path), image.t_us, gamma=self.gamma)


def _listed(folder: Path) -> list[ListedImage]:
    """The images, which are there and in order of time. Raises SourceError naming the line."""
    path = folder / IMAGE_LIST
    try:
        listed = read_image_list(path)
    except FileNotFoundError:
        raise SourceError(
            f"{folder}: no {IMAGE_LIST} in this folder; images need their times: a line 'seconds filename' "
            "for each"
        ) from None
    except FormatError as error:
        raise SourceError(str(error)) from None
    except (OSError, UnicodeDecodeError) as error:
        raise SourceError(f"{path}: cannot be read: {error}") from None
    if not listed:
        raise SourceError(f"{path}: lists no image; write a line 'seconds filename' for each")
    before_us: int | None = None
    for image in listed:
        where = f"{path}, line {image.line}"
        if before_us is not None and image.t_us <= before_us:
            raise SourceError(
                f"{where}: {image.t_us} us is not later than the line before ({before_us} us); sort the list "
                "by time and remove repeated lines"
            )
        if not image.path.is_file():
            raise SourceError(f"{where}: no such image; copy it or remove the line")
        before_us = image.t_us
    return listed


def _read_image(path: Path) -> Image:
    image = cv2.imread(str(path), cv2.IMREAD_ANYCOLOR | cv2.IMREAD_ANYDEPTH)
    if image is None:
        raise SourceError(
            f"{path}: not an image OpenCV can read; replace it or remove its line from {IMAGE_LIST}"
        )
    return luminance(image)
