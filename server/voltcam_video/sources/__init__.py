"""One file per kind of source; `open_source` picks by the uri."""

import threading

from voltcam_video.clock import Clock
from voltcam_video.request import SourceRequest
from voltcam_video.sources.device import DeviceSource
from voltcam_video.sources.file import FileSource
from voltcam_video.sources.images import ImagesSource
from voltcam_video.sources.memory import MemorySource
from voltcam_video.sources.network import NetworkSource
from voltcam_video.sources.npz import NpzSource
from voltcam_video.sources.photos import PhotosSource
from voltcam_video.sources.pushed import PushedSource
from voltcam_video.sources.ros1 import Ros1Source
from voltcam_video.sources.ros2 import Ros2Source
from voltcam_video.sources.scene import SceneSource
from voltcam_video.sources.source import Granted, Source, SourceError

__all__ = ["SOURCES", "Granted", "MemorySource", "Source", "SourceError", "open_source"]

SOURCES: tuple[type[Source], ...] = (
    SceneSource,
    PhotosSource,
    DeviceSource,
    PushedSource,
    Ros1Source,
    Ros2Source,
    NetworkSource,
    ImagesSource,
    NpzSource,
    FileSource,
)
"""Asked in this order; the first that `reads` a request opens it. The last takes any path."""


def open_source(
    request: SourceRequest, clock: Clock | None = None, stop: threading.Event | None = None
) -> Source:
    """Opens what `request.uri` names. Raises SourceError.

    clock: what live frames and real-time pacing are stamped with. stop: ends the wait for a frame's due time,
    and with it the recording.
    """
    return _kind(request)(request, clock or Clock(), stop or threading.Event())


def _kind(request: SourceRequest) -> type[Source]:
    path = request.path
    if path is not None and path.exists() and not (path.is_file() or path.is_dir()):
        # reading a pipe or a socket may wait for ever
        raise SourceError(f"{request.shown} is neither a file nor a folder: give a recording")
    return next(kind for kind in SOURCES if kind.reads(request))
