"""What is known of a scene from photographs, frame by frame, in an HDF5 file beside its events.

t_us          int64 (N,)
light         float32 (N, H, W), 0..255 DN: the frames that were simulated
flow          float32 (N, H, W, 2), x and y [pixels/s]: velocity of what a pixel shows
order         uint8 (N, H, W): the layer that it shows; 0 is the background, higher ones are nearer
homographies  float64 (N, layers, 3, 3), from each plane to the frame
attributes    source, width, height
"""

from pathlib import Path
from types import TracebackType
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from voltcam_video.photos import PhotoScene


class GroundTruthWriter:
    """A context manager. Raises FileExistsError unless overwrite, OSError."""

    def __init__(self, path: Path, scene: PhotoScene, source: str, *, overwrite: bool = False) -> None:
        self.path, self._scene = path, scene
        size = scene.height, scene.width
        self._file = h5py.File(path, "w" if overwrite else "x")
        self._file.attrs.update(source=source, width=scene.width, height=scene.height)
        self._columns = {
            "t_us": self._column("t_us", "<i8"),
            "light": self._column("light", "<f4", *size),
            "flow": self._column("flow", "<f4", *size, 2),
            "order": self._column("order", "u1", *size),
            "homographies": self._column("homographies", "<f8", scene.layers, 3, 3),
        }

    def frame(self, light: NDArray[Any], t_us: int) -> None:
        """Adds what is known of the frame at that time."""
        known = {
            "t_us": t_us,
            "light": light,
            "flow": self._scene.flow(t_us),
            "order": self._scene.order(t_us),
            "homographies": self._scene.homographies(t_us),
        }
        for name, value in known.items():
            column = self._columns[name]
            column.resize(len(column) + 1, axis=0)
            column[-1] = np.asarray(value)

    def _column(self, name: str, kind: str, *shape: int) -> Any:
        more = {"compression": "gzip", "compression_opts": 1, "shuffle": True} if shape else {}
        chunk = (1, *shape) if shape else (1024,)
        return self._file.create_dataset(
            name, (0, *shape), kind, maxshape=(None, *shape), chunks=chunk, **more
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        for column in self._columns.values():  # in one order, and so into the same bytes
            column.flush()
        self._file.close()
