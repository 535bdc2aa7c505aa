"""The pixels of a sensor, on the device that is asked for."""

from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from .law import Law
from .pixel_array import PixelArray

if TYPE_CHECKING:
    from .cuda.cuda_pixels import CudaPixels

Device = Literal["cpu", "cuda"]
"""What simulates: a processor, or a GPU."""

SensorPixels: TypeAlias = "PixelArray | CudaPixels"


class NoDeviceError(RuntimeError):
    """There is no GPU, or something that it needs is missing."""


def sensor_pixels(device: Device, width: int, height: int, law: Law, seed: int, threads: int) -> SensorPixels:
    """Those of a processor, or of a GPU; what that needs is imported for it alone.

    Raises ValueError for another device, and NoDeviceError where there is no GPU.
    """
    if device == "cpu":
        return PixelArray(width, height, law, seed, threads)
    if device != "cuda":
        raise ValueError(f"unknown device {device!r}: give 'cpu' or 'cuda'")
    from .cuda.cuda_pixels import CudaPixels

    return CudaPixels(width, height, law, seed)


def device_events(keys: Any, start_us: int) -> Any:
    """Sorted keys on a GPU as events there."""
    from .cuda.events import events_of

    return events_of(keys, start_us)
