"""Compile every kernel for capability 9.0, without a device: a line each; 77: NVVM or NVRTC is missing."""

import sys
from typing import Any

import numpy as np
from numba import cuda, typeof
from numba.cuda import dispatcher

from voltcam_simulator import Parameters, Simulator
from voltcam_simulator.cuda import arrays, frames
from voltcam_simulator.cuda.events import events_of

CAPABILITY = (9, 0)


class Device:
    """The device that kernels are compiled for."""

    compute_capability = CAPABILITY


def compiled(kernel: Any, threads: int, *groups: Any) -> None:
    """In the place of a launch."""
    with arrays.unfused():
        ptx, _ = cuda.compile_ptx(kernel.py_func, tuple(typeof(group) for group in groups), cc=CAPABILITY)
    assert ".entry" in ptx
    assert "vprintf" not in ptx
    assert "malloc" not in ptx
    if kernel.py_func.__name__ == "settle":  # others have some from the device's own exp and log
        assert "fma.rn" not in ptx
    print(kernel.py_func.__name__, len(ptx))  # noqa: T201
    if kernel.py_func.__name__ == "step_all":
        groups[-1].counts[2] = 1  # a pixel is late


try:
    from numba.cuda.cudadrv.nvrtc import get_supported_ccs
    from numba.cuda.cudadrv.nvvm import NVVM

    NVVM()
    get_supported_ccs()
except Exception:
    sys.exit(77)
dispatcher.get_current_device = lambda: Device
arrays.SIMULATED, frames.SIMULATED = True, True  # arrays are NumPy's; kernels are not simulated
arrays.require = lambda: None
arrays.launch = compiled
parameters = Parameters.of("typical").changed(
    {
        "exposure_blur": {"exposure_us": 900.0},
        "vignetting": {"corner_loss": 0.4},
        "photoreceptor_bandwidth": {"cutoff_hz": 300.0, "follower_hz": 700.0},
        "residual_drift": {"per_us": 1e-6},
        "residual_noise": {"variance_per_us": 1e-9},
        "frame_noise": {"slack_dn": 2.0},
        "input_response": {"gamma_exponent": 2.2},
        "leak_mismatch": {"sigma": 0.2},
        "aps_coupling": {"reset_kick": 0.1},
        "residual_clock": {"kick": 0.1},
    }
)
simulator = Simulator(4, 3, parameters, device="cuda")
simulator.advance(np.zeros((3, 4), np.uint8), 0)
simulator.advance(np.full((3, 4), 9, np.uint8), 1000)


class There:
    """A frame on the device."""

    __cuda_array_interface__ = np.zeros((3, 4), np.float32).__array_interface__


frames.device_image(There(), 3, 4)
events_of(np.zeros(3, np.uint64), 0)
