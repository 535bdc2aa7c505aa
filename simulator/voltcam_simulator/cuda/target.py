"""numba's CUDA, in which types are unknown, and how its functions are marked."""

from collections.abc import Callable
from typing import Any

from numba import cuda as _cuda

cuda: Any = _cuda


def launched(function: Callable[..., None]) -> Any:
    """A kernel: runs in as many threads as it is launched with."""
    return cuda.jit(function)


def on_device(function: Callable[..., Any]) -> Any:
    """A function that kernels call, and that may use what only a device has."""
    return cuda.jit(device=True)(function)
