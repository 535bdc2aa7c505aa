"""The types of messages that Voltcam publishes or takes, with the MD5 sums that ROS 1 knows them by."""

import hashlib
import re
from functools import cache
from typing import NamedTuple

from voltcam_client.formats.ros_messages import DEFINITIONS

_DEFINITIONS = {
    "std_msgs/Header": "uint32 seq\ntime stamp\nstring frame_id",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "rosgraph_msgs/Clock": "time clock",
    "sensor_msgs/Image": "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
    "uint8 is_bigendian\nuint32 step\nuint8[] data",
    "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
    "sensor_msgs/RegionOfInterest": "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\n"
    "bool do_rectify",
    "sensor_msgs/CameraInfo": "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n"
    "float64[] D\nfloat64[9] K\nfloat64[9] R\nfloat64[12] P\nuint32 binning_x\nuint32 binning_y\n"
    "sensor_msgs/RegionOfInterest roi",
    "sensor_msgs/Imu": "std_msgs/Header header\n"
    "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance",
} | {
    name.replace("/msg/", "/"): fields.replace("builtin_interfaces/Time", "time")
    for name, fields in DEFINITIONS.items()
}
_FIELD = re.compile(r"(\w+/\w+)(?:\[\d*\])? (\w+)")


class MessageType(NamedTuple):
    """definition: its fields, and after them those of the messages within, as ROS 1 sends them along."""

    name: str
    md5: str
    definition: str


@cache
def message_type(name: str) -> MessageType:
    """One of the types above, such as sensor_msgs/Image. Raises KeyError."""
    parts = [f"{'=' * 80}\nMSG: {each}\n{_DEFINITIONS[each]}\n" for each in _within(name)]
    return MessageType(name, _md5(name), "\n".join([_DEFINITIONS[name] + "\n", *parts]))


def _md5(name: str) -> str:
    """Of the definition, in which each message within stands as its own sum, arrays of it too."""
    text = _FIELD.sub(lambda field: f"{_md5(field[1])} {field[2]}", _DEFINITIONS[name])
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()


def _within(name: str) -> list[str]:
    """All messages within one, each once."""
    found = [field[1] for field in _FIELD.finditer(_DEFINITIONS[name])]
    return list(dict.fromkeys(each for inner in found for each in (inner, *_within(inner))))
