"""Messages of ROS 1 as bytes: what a daemon sends, in the types that drivers of a DAVIS publish.

Stamps are the events' own clock: a packet's at its start, an APS frame's in the middle of its exposure, as
rpg_dvs_ros (davis_ros_driver) has it from libcaer. Axes are those of the camera's image, z along the view.
"""

import struct

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats.ros_messages import ros1_array, ros1_header
from voltcam_client.intrinsics import Intrinsics
from voltcam_client.packet import FrameMessage, Packet, encode_packet

STANDARD_GRAVITY_M_S2 = 9.80665
_UNKNOWN_ORIENTATION = np.array([0, 0, 0, 0, -1, *[0] * 8], "<f8").tobytes()
"""A quaternion of zeros, and its covariance, whose first element says that there is none."""
_NO_COVARIANCE = bytes(72)


def event_packet(packet: Packet, sequence: int, frame_id: str) -> bytes:
    """event_camera_msgs/EventPacket, its events encoded as the daemon has them."""
    header = ros1_header(packet.time_base_ns // 1000, sequence, frame_id)
    events = encode_packet(packet)[1]
    numbers = struct.pack("<IIQQ", packet.height, packet.width, packet.seq, packet.time_base_ns)
    return b"".join((header, numbers, _text(packet.encoding), b"\0", struct.pack("<I", len(events)), events))


def event_array(packet: Packet, sequence: int, frame_id: str) -> bytes:
    """dvs_msgs/EventArray."""
    size = packet.width, packet.height
    return bytes(ros1_array(packet.events, packet.time_base_ns // 1000, sequence, frame_id, *size))


def image(frame: FrameMessage, sequence: int, frame_id: str) -> bytes:
    """sensor_msgs/Image, mono8."""
    height, width = frame.image.shape
    header = ros1_header(frame.t_us, sequence, frame_id) + struct.pack("<II", height, width)
    layout = _text("mono8") + struct.pack("<BII", 0, width, height * width)
    return b"".join((header, layout, frame.image.tobytes()))


def camera_info(frame: FrameMessage, intrinsics: Intrinsics, sequence: int, frame_id: str) -> bytes:
    """sensor_msgs/CameraInfo of an image."""
    height, width = frame.image.shape
    distortion = np.array(intrinsics.distortion, "<f8")
    matrices = [np.array(each, "<f8") for each in (intrinsics.k, intrinsics.r, intrinsics.p)]
    return b"".join(
        (
            ros1_header(frame.t_us, sequence, frame_id) + struct.pack("<II", height, width),
            _text(intrinsics.model) + struct.pack("<I", distortion.size),
            *(each.tobytes() for each in (distortion, *matrices)),
            bytes(25),  # no binning, no region of interest
        )
    )


def imu(sample: NDArray[np.void] | np.void, sequence: int, frame_id: str) -> bytes:
    """sensor_msgs/Imu of one sample, in rad/s and m/s^2."""
    rotation = np.deg2rad(sample["gyro_deg_s"].astype("<f8"))
    acceleration = sample["accel_g"].astype("<f8") * STANDARD_GRAVITY_M_S2
    header = ros1_header(int(sample["t"]), sequence, frame_id) + _UNKNOWN_ORIENTATION
    return b"".join((header, rotation.tobytes(), _NO_COVARIANCE, acceleration.tobytes(), _NO_COVARIANCE))


def clock(t_us: int) -> bytes:
    """rosgraph_msgs/Clock."""
    return struct.pack("<II", t_us // 1_000_000, t_us % 1_000_000 * 1000)


def _text(text: str) -> bytes:
    return struct.pack("<I", len(text.encode())) + text.encode()
