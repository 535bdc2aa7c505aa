"""Voltcam's client: subscribe to an emulated event camera, turn its parameters, send frames to it, read and
write recordings.
"""

from voltcam_client.camera import EventCamera
from voltcam_client.control import Control
from voltcam_client.errors import ControlError, PacketError, VoltcamError
from voltcam_client.frame_sender import FrameError, FrameSender
from voltcam_client.packet import EVENT, FrameMessage, Packet

__all__ = [
    "EVENT",
    "Control",
    "ControlError",
    "EventCamera",
    "FrameError",
    "FrameMessage",
    "FrameSender",
    "Packet",
    "PacketError",
    "VoltcamError",
]
