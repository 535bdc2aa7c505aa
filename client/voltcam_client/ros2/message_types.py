"""The types of messages that are published or taken: their fields for DDS, and the hash ROS 2 knows them by.

In DDS a type and its fields have an underscore after their names. The objects that are written and read hold
packed CDR: Cyclone's own way, field by field, is 15 times as slow.

Sources: design.ros2.org/articles/mapping_dds_types.html; ros2/common_interfaces; REP 2011 (type hashes).
"""

import importlib
from functools import cache
from typing import Any

from voltcam_client.ros2 import Ros2Error

EVENTS = "event_camera_msgs/EventPacket"
EVENT_ARRAY = "dvs_msgs/EventArray"
IMAGE = "sensor_msgs/Image"
COMPRESSED_IMAGE = "sensor_msgs/CompressedImage"
CAMERA_INFO = "sensor_msgs/CameraInfo"
IMU = "sensor_msgs/Imu"

FIELDS: dict[str, dict[str, str]] = {
    "builtin_interfaces/Time": {"sec": "int32", "nanosec": "uint32"},
    "std_msgs/Header": {"stamp": "builtin_interfaces/Time", "frame_id": "string"},
    "geometry_msgs/Quaternion": dict.fromkeys("xyzw", "float64"),
    "geometry_msgs/Vector3": dict.fromkeys("xyz", "float64"),
    "sensor_msgs/RegionOfInterest": dict.fromkeys(("x_offset", "y_offset", "height", "width"), "uint32")
    | {"do_rectify": "bool"},
    EVENTS: {"header": "std_msgs/Header", "height": "uint32", "width": "uint32", "seq": "uint64"}
    | {"time_base": "uint64", "encoding": "string", "is_bigendian": "bool", "events": "uint8[]"},
    "dvs_msgs/Event": {"x": "uint16", "y": "uint16", "ts": "builtin_interfaces/Time", "polarity": "bool"},
    EVENT_ARRAY: {"header": "std_msgs/Header", "height": "uint32", "width": "uint32"}
    | {"events": "dvs_msgs/Event[]"},
    IMAGE: {"header": "std_msgs/Header", "height": "uint32", "width": "uint32", "encoding": "string"}
    | {"is_bigendian": "uint8", "step": "uint32", "data": "uint8[]"},
    COMPRESSED_IMAGE: {"header": "std_msgs/Header", "format": "string", "data": "uint8[]"},
    CAMERA_INFO: {"header": "std_msgs/Header", "height": "uint32", "width": "uint32"}
    | {"distortion_model": "string", "d": "float64[]", "k": "float64[9]", "r": "float64[9]"}
    | {"p": "float64[12]", "binning_x": "uint32", "binning_y": "uint32"}
    | {"roi": "sensor_msgs/RegionOfInterest"},
    IMU: {"header": "std_msgs/Header", "orientation": "geometry_msgs/Quaternion"}
    | {"orientation_covariance": "float64[9]", "angular_velocity": "geometry_msgs/Vector3"}
    | {"angular_velocity_covariance": "float64[9]", "linear_acceleration": "geometry_msgs/Vector3"}
    | {"linear_acceleration_covariance": "float64[9]"},
}
HASHES = {
    EVENTS: "d6fa176260b1f37e5a40845305315e150a0f18191241eb64f407442aa29844aa",
    EVENT_ARRAY: "0ea4aa5f4670adab1336550158b2e3c9bf60fe515a284c4215ed605bd559c995",
    IMAGE: "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    COMPRESSED_IMAGE: "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
    CAMERA_INFO: "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275",
    IMU: "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
}
"""RIHS01: without it a ROS 2 from Iron on warns of each topic."""


class PackedMessage:
    """A message as CDR, with its encapsulation."""

    def __init__(self, cdr: bytes) -> None:
        self.cdr = cdr


def library(name: str) -> Any:
    """A module of cyclonedds. Raises Ros2Error."""
    try:
        return importlib.import_module(f"cyclonedds.{name}")
    except ImportError as error:
        raise Ros2Error(f"ROS 2 needs pip install 'voltcam[ros2]' ({error})") from None


@cache
def dds_type(name: str) -> Any:
    """Cyclone's class of a type in FIELDS, whose objects take and have `cdr`. Raises Ros2Error."""
    kind = structure(name)
    # What Cyclone's writers and readers call; its own would go field by field.
    kind.__init__ = PackedMessage.__init__
    kind.serialize = lambda self, *_, **__: self.cdr
    kind.deserialize = lambda data, *_, **__: kind(data)
    kind.deserialize_key = kind.deserialize  # of what says that a writer has left
    return kind


def structure(name: str) -> Any:
    """Cyclone's class of a type, its fields with an underscore after their names. Raises Ros2Error."""
    package, _, short = name.partition("/")
    fields = {f"{field}_": _field(kind) for field, kind in FIELDS[name].items()}
    return library("idl").make_idl_struct(f"{short}_", f"{package}.msg.dds_.{short}_", fields)


def _field(kind: str) -> Any:
    types = library("idl.types")
    inner, bracket, count = kind.removesuffix("]").partition("[")
    one: Any = {"string": str, "bool": bool}.get(inner)
    one = one or (structure(inner) if "/" in inner else getattr(types, inner))
    if not bracket:
        return one
    return types.array[one, int(count)] if count else types.sequence[one]
