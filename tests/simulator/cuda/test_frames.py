"""Frames that are on the device already; in numba's simulator its memory is the host's."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.cuda.arrays import SIMULATED
from voltcam_simulator.cuda.frames import ON_CUDA, device_image

pytestmark = pytest.mark.skipif(not SIMULATED, reason="memory of these frames is the host's")


class OnDevice:
    """An array of another library on the device: NumPy cannot read it."""

    def __init__(self, array: NDArray[Any]) -> None:
        self.array = array
        self.__cuda_array_interface__ = dict(array.__array_interface__)

    def __array__(self, *_: Any, **__: Any) -> NDArray[Any]:
        raise TypeError("this array goes through the host")


class ByDlpack:
    """One that only knows DLPack."""

    def __init__(self, array: NDArray[Any]) -> None:
        self.array = array

    def __dlpack_device__(self) -> tuple[int, int]:
        return ON_CUDA, 0

    def __dlpack__(self, **_: Any) -> Any:
        return self.array.__dlpack__()

    def __array__(self, *_: Any, **__: Any) -> NDArray[Any]:
        raise TypeError("this array goes through the host")


FRAME = np.arange(12, dtype=np.uint8).reshape(3, 4)


@pytest.mark.parametrize("kind", [OnDevice, ByDlpack])
@pytest.mark.parametrize("dtype", [np.uint8, np.float32, np.float64, np.int16])
def test_device_arrays_are_taken_without_the_host(kind: type, dtype: type) -> None:
    wide = np.zeros((3, 8), dtype)
    wide[:, ::2] = FRAME
    image = device_image(kind(wide[:, ::2]), 3, 4)  # strides and all
    np.testing.assert_array_equal(image, FRAME.ravel())
    assert image.dtype == (np.uint8 if dtype is np.uint8 else np.float32)
    wide[:] = 99
    np.testing.assert_array_equal(image, FRAME.ravel())  # it is an own copy


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
@pytest.mark.parametrize("kind", [np.asarray, OnDevice])
def test_light_that_cannot_be_is_refused_and_changes_nothing(kind: Any, bad: float) -> None:
    simulator = Simulator(4, 3, Parameters.of("ideal"), device="cuda")
    simulator.advance(FRAME, 0)
    before = simulator.snapshot()
    frame = FRAME.astype(np.float32)
    frame[1, 2] = bad
    with pytest.raises(ValueError, match="negative or not finite"):
        simulator.advance(kind(frame), 1000)
    after = simulator.snapshot()
    assert all(np.array_equal(before[name], after[name]) for name in before)


def test_a_frame_of_another_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="the sensor"):
        device_image(OnDevice(FRAME), 4, 3)
    with pytest.raises(ValueError, match="real numbers"):
        device_image(OnDevice(FRAME.astype(complex)), 3, 4)
