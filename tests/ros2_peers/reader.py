"""A program of DDS without Voltcam: `python reader.py TOPIC TYPE COUNT FILE [best_effort] [telling]`.

Its types are written as in IDL, and Cyclone's own deserialiser reads them, field by field. It says when a
writer is found (telling: and each time a message came), and saves the fields as JSON lines, bytes as hex.
"""

import dataclasses
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, sequence, uint8, uint32, uint64
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclasses.dataclass
class Time(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec_: int32
    nanosec_: uint32


@dataclasses.dataclass
class Header(IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    stamp_: Time
    frame_id_: str


@dataclasses.dataclass
class EventPacket(IdlStruct, typename="event_camera_msgs.msg.dds_.EventPacket_"):
    header_: Header
    height_: uint32
    width_: uint32
    seq_: uint64
    time_base_: uint64
    encoding_: str
    is_bigendian_: bool
    events_: sequence[uint8]


@dataclasses.dataclass
class Image(IdlStruct, typename="sensor_msgs.msg.dds_.Image_"):
    header_: Header
    height_: uint32
    width_: uint32
    encoding_: str
    is_bigendian_: uint8
    step_: uint32
    data_: sequence[uint8]


@dataclasses.dataclass
class RegionOfInterest(IdlStruct, typename="sensor_msgs.msg.dds_.RegionOfInterest_"):
    x_offset_: uint32
    y_offset_: uint32
    height_: uint32
    width_: uint32
    do_rectify_: bool


@dataclasses.dataclass
class CameraInfo(IdlStruct, typename="sensor_msgs.msg.dds_.CameraInfo_"):
    header_: Header
    height_: uint32
    width_: uint32
    distortion_model_: str
    d_: sequence[float64]
    k_: array[float64, 9]
    r_: array[float64, 9]
    p_: array[float64, 12]
    binning_x_: uint32
    binning_y_: uint32
    roi_: RegionOfInterest


@dataclasses.dataclass
class Quaternion(IdlStruct, typename="geometry_msgs.msg.dds_.Quaternion_"):
    x_: float64
    y_: float64
    z_: float64
    w_: float64


@dataclasses.dataclass
class Vector3(IdlStruct, typename="geometry_msgs.msg.dds_.Vector3_"):
    x_: float64
    y_: float64
    z_: float64


@dataclasses.dataclass
class Imu(IdlStruct, typename="sensor_msgs.msg.dds_.Imu_"):
    header_: Header
    orientation_: Quaternion
    orientation_covariance_: array[float64, 9]
    angular_velocity_: Vector3
    angular_velocity_covariance_: array[float64, 9]
    linear_acceleration_: Vector3
    linear_acceleration_covariance_: array[float64, 9]


TYPES = {each.__name__: each for each in (EventPacket, Image, CameraInfo, Imu)}


def plain(value: Any) -> Any:
    """Fields by name; bytes as hex."""
    if isinstance(value, IdlStruct):
        return {
            field.name: plain(getattr(value, field.name))
            for field in dataclasses.fields(value)  # type: ignore[arg-type]
        }
    if isinstance(value, (bytes, bytearray)):
        return bytes(value).hex()
    if isinstance(value, (list, tuple)):
        whole = value and all(isinstance(each, int) and 0 <= each < 256 for each in value)
        return bytes(value).hex() if whole else list(value)
    return value


if __name__ == "__main__":
    name, kind, count, file, *options = sys.argv[1:]
    participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
    best_effort = "best_effort" in options
    reliability = Policy.Reliability.BestEffort if best_effort else Policy.Reliability.Reliable(0)
    reader = DataReader(
        participant,
        Topic(participant, name, TYPES[kind]),
        Qos(reliability, Policy.Durability.Volatile, Policy.History.KeepLast(1000)),
    )
    while not reader.get_matched_publications():
        time.sleep(0.01)
    sys.stdout.write("found\n")
    sys.stdout.flush()
    came = reader.take_iter(timeout=duration(seconds=20))
    with Path(file).open("w") as lines:
        for _, message in zip(range(int(count)), came, strict=False):
            lines.write(json.dumps(plain(message)) + "\n")
            if "telling" in options:
                sys.stdout.write("one\n")
                sys.stdout.flush()
