"""The light that a recording's frames tell of, as densely in time as a simulator needs it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voltcam_video import Frame, Upsampling, between


@dataclass(frozen=True, eq=False)
class Scene:
    """images: (N, H, W) float32 grey levels [DN]; t_us: (N,) int64, ascending. Between two images, ln L is
    straight, as a simulator draws it."""

    images: NDArray[np.float32]
    t_us: NDArray[np.int64]

    @property
    def height(self) -> int:
        """Rows."""
        return int(self.images.shape[1])

    @property
    def width(self) -> int:
        """Columns."""
        return int(self.images.shape[2])

    def frames(self) -> Iterator[Frame]:
        """The same, one by one."""
        for image, t_us in zip(self.images, self.t_us.tolist(), strict=True):
            yield Frame(image, t_us)


def scene_of(images: NDArray[np.uint8], t_us: NDArray[np.int64], how: Upsampling = "auto") -> Scene:
    """Frames (N, H, W) with more between them: `how` as in voltcam_video.between."""
    given = (Frame(image, int(t)) for image, t in zip(images, t_us, strict=True))
    dense = list(between(given, how))
    return Scene(
        np.stack([frame.image for frame in dense]).astype(np.float32, copy=False),
        np.array([frame.t_us for frame in dense], np.int64),
    )
