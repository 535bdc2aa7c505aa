"""Frames that are in memory already: a recording's."""

import threading
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from voltcam_video.clock import Clock
from voltcam_video.frame import Frame
from voltcam_video.request import SourceRequest
from voltcam_video.sources.recorded import RecordedSource
from voltcam_video.sources.source import Granted, SourceError


class MemorySource(RecordedSource):
    """images (N, H, W) uint8 at t_us (N,), which must advance; `request.uri` names them."""

    def __init__(
        self,
        request: SourceRequest,
        images: NDArray[np.uint8],
        t_us: NDArray[np.int64],
        clock: Clock | None = None,
        stop: threading.Event | None = None,
    ) -> None:
        super().__init__(request, clock or Clock(), stop or threading.Event())
        self._images, self._t_us = images, t_us
        back = np.flatnonzero(np.diff(t_us) <= 0)
        if back.size:
            i = int(back[0]) + 1
            raise SourceError(
                f"{request.shown}: frame {i} is at {t_us[i]} us, not later than the one before "
                f"({t_us[i - 1]} us); sort the frames by time and remove repeated ones"
            )
        self.granted = Granted(
            kind="recording",
            live=False,
            width=images.shape[2],
            height=images.shape[1],
            fps=float((len(t_us) - 1) * 1e6 / (t_us[-1] - t_us[0])) if len(t_us) > 1 else None,
            pixel_format=None,
            frames=len(images),
            backend=None,
            clock="recording",
            levels=self.levels,
        )

    def _take(self) -> Iterator[Frame]:
        for image, t_us in zip(self._images, self._t_us.tolist(), strict=True):
            yield Frame(image, t_us, gamma=self.gamma)
