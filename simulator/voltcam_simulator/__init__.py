"""The DVS pixel as a stochastic process: frames in, events out, state kept between frames.

Pure: arrays in, arrays out; no network, no files but camera files, no clock, no OpenCV.

    from voltcam_simulator import Parameters, Simulator
    simulator = Simulator(width=346, height=260, parameters=Parameters.of("davis346"), seed=1)
    events = simulator.advance(frame, t_us)
"""

from .aps_frames import ApsFrame, ApsFrames
from .camera import Camera
from .camera_file import camera_names
from .effect import EVENT
from .imu import ImuAtRest
from .law import Law
from .limits import GivenUpError, Limits, TooLongError, TooManyEventsError
from .parameters import Parameters
from .sensor_pixels import Device, NoDeviceError
from .simulator import Drawn, Simulator

__all__ = [
    "EVENT",
    "ApsFrame",
    "ApsFrames",
    "Camera",
    "Device",
    "Drawn",
    "GivenUpError",
    "ImuAtRest",
    "Law",
    "Limits",
    "NoDeviceError",
    "Parameters",
    "Simulator",
    "TooLongError",
    "TooManyEventsError",
    "camera_names",
]
