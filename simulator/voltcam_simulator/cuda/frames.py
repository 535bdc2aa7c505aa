"""Frames as the device has them: from the host, or from where another library has them on the device."""

import importlib
from typing import Any, NamedTuple

import numpy as np

from ..frames import BRIGHTEST_DN, NO_LIGHT, checked_kind, checked_shape, host_image
from ..kernel import kernel
from . import arrays
from .arrays import SIMULATED, DeviceArray
from .target import cuda, launched

ON_CUDA = 2
"""DLPack's number for memory of a CUDA device."""


class FrameThere(NamedTuple):
    """A frame of any real type on the device, and where it goes."""

    frame: Any
    """(height, width)."""
    image: Any
    """(height * width,) uint8 or float32."""
    bad: Any
    """(1,) int32: becomes 1 where a grey level is no light."""


def device_image(frame: Any, height: int, width: int) -> DeviceArray:
    """An own copy (height * width,) of a frame, uint8 or float32.

    frame: what NumPy takes, or an array on the device: of any library that has `__cuda_array_interface__`, or
    DLPack (torch, cupy, jax); such a one is copied on the device. Raises ValueError as `host_image`.
    """
    found = on_device(frame)
    if found is None:
        return arrays.upload(host_image(frame, height, width).ravel())
    checked_shape(found.shape, height, width)
    checked_kind(found.dtype)
    dtype = np.uint8 if found.dtype == np.uint8 else np.float32
    source = FrameThere(found, arrays.empty(height * width, dtype), arrays.zeros(1, np.int32))
    arrays.launch(_take, height * width, source)
    if dtype == np.float32 and arrays.download(source.bad)[0]:
        raise ValueError(NO_LIGHT)
    return source.image


def on_device(frame: Any) -> DeviceArray | None:
    """The frame as the device's kernels take it, without a copy, or None if it is on the host."""
    if not hasattr(frame, "__cuda_array_interface__"):
        kind = getattr(frame, "__dlpack_device__", None)
        if kind is None or kind()[0] != ON_CUDA:
            return None
        frame = _Memory(_interface_of_dlpack(frame), frame)
    if SIMULATED:  # its memory is the host's
        return np.asarray(_Host(frame.__cuda_array_interface__))
    return cuda.as_cuda_array(frame)


class _Memory:
    """Memory of another library, for as long as it is needed."""

    def __init__(self, interface: dict[str, Any], owner: object) -> None:
        self.__cuda_array_interface__, self._owner = interface, owner


class _Host:
    """The same memory as NumPy takes it."""

    def __init__(self, interface: dict[str, Any]) -> None:
        self.__array_interface__ = {key: interface[key] for key in ("shape", "typestr", "data", "version")}
        self.__array_interface__["strides"] = interface.get("strides")


def _interface_of_dlpack(frame: Any) -> dict[str, Any]:
    """What an array that knows only DLPack would say by `__cuda_array_interface__`."""
    utils: Any = importlib.import_module("cuda.core.utils")  # numba-cuda brings it
    view = utils.StridedMemoryView.from_dlpack(frame, stream_ptr=-1)
    itemsize = np.dtype(view.dtype).itemsize
    strides = None if view.strides is None else tuple(step * itemsize for step in view.strides)
    return {
        "shape": tuple(view.shape), "typestr": np.dtype(view.dtype).str, "data": (view.ptr, True),
        "strides": strides, "version": 3,
    }  # fmt: skip


@launched
def _take(source: Any) -> None:
    i = cuda.grid(1)
    if i < source.image.shape[0]:
        take_pixel(source.frame, source.image, source.bad, i)


@kernel
def take_pixel(frame: Any, image: Any, bad: Any, i: Any) -> None:
    """Copy grey level i of a frame, row after row."""
    width = frame.shape[1]
    value = np.float32(frame[i // width, i % width])
    if not (value >= 0 and value <= BRIGHTEST_DN):
        bad[0] = 1
    image[i] = value
