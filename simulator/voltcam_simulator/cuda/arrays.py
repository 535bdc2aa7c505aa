"""Arrays on the device: made, copied there and back, sorted.

With NUMBA_ENABLE_CUDASIM=1 there is no device: kernels run as Python, and arrays are NumPy's. (Inside a
group, the simulator hands them to kernels as they are; so kernels compiled for the processor take them, too.)
"""

import importlib
import importlib.util
from typing import Any

import numpy as np
from numba.core import config
from numpy.typing import DTypeLike, NDArray

from ..sensor_pixels import NoDeviceError
from .target import cuda
from .unfused import install, unfused

DeviceArray = Any
"""numba.cuda's, with `__cuda_array_interface__`; NumPy's where the device is simulated."""

_settings: Any = config
SIMULATED: bool = bool(_settings.ENABLE_CUDASIM)
THREADS = 128
"""Of a block: pixels have different amounts of work, so small blocks make room for others sooner."""
FEWEST_BLOCKS = 1 if SIMULATED else 128
"""Of a launch: for fewer, numba warns that they leave a device idle. Kernels look if they have a pixel."""
REMEDY = "install a GPU driver and voltcam[cuda] (CUDA 13) or voltcam[cuda12], or leave device cuda out"


install()


def require() -> None:
    """Raises NoDeviceError, in one line, where kernels cannot run."""
    if SIMULATED:
        return
    for module, package in (("numba_cuda", "numba-cuda"), ("cuda.compute", "cuda-cccl")):
        if not _found(module):
            raise NoDeviceError(f"device cuda needs the package {package}: {REMEDY}")
    if not cuda.is_available():
        raise NoDeviceError(f"device cuda finds no GPU, or no driver for it: {REMEDY}")


def _found(module: str) -> bool:
    try:
        return importlib.util.find_spec(module) is not None
    except ModuleNotFoundError:  # not even what it is in
        return False


def zeros(shape: int | tuple[int, ...], dtype: DTypeLike) -> DeviceArray:
    """An array of zeros."""
    return upload(np.zeros(shape, dtype))


def empty(shape: int | tuple[int, ...], dtype: DTypeLike) -> DeviceArray:
    """Space that holds anything."""
    return np.empty(shape, dtype) if SIMULATED else cuda.device_array(shape, dtype)


def upload(array: NDArray[Any]) -> DeviceArray:
    """A copy on the device."""
    return array.copy(order="C") if SIMULATED else cuda.to_device(np.ascontiguousarray(array))


def download(array: DeviceArray) -> NDArray[Any]:
    """A copy on the host."""
    return np.array(array) if SIMULATED else np.asarray(array.copy_to_host())


def on_host(array: DeviceArray) -> NDArray[Any]:
    """A copy on the host of an array that may be there already."""
    return array.copy() if isinstance(array, np.ndarray) else download(array)


def fill(array: DeviceArray, values: DeviceArray) -> None:
    """The array takes values (of its shape), from the host or the device."""
    if SIMULATED:
        array[...] = values
    elif array.size:
        array.copy_to_device(np.ascontiguousarray(values) if isinstance(values, np.ndarray) else values)


def launch(kernel: Any, threads: int, *groups: Any) -> None:
    """Run a kernel for that many threads; arrays only within groups."""
    if threads:
        with unfused():  # the first launch compiles
            kernel[max(-(-threads // THREADS), FEWEST_BLOCKS), THREADS](*groups)


def in_order(keys: DeviceArray, bits: int) -> DeviceArray:
    """uint64 keys in rising order, of which only that many low bits count; on the device, by radix sort."""
    if SIMULATED or not keys.size:
        return np.sort(keys) if SIMULATED else keys
    cub: Any = importlib.import_module("cuda.compute")
    ordered = empty(keys.size, np.uint64)
    cub.radix_sort(
        d_in_keys=keys, d_out_keys=ordered, num_items=keys.size, order=cub.SortOrder.ASCENDING, begin_bit=0,
        end_bit=bits,
    )  # fmt: skip
    return ordered
