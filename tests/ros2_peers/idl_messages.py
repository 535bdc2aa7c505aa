"""Messages of ROS 2 as IDL has them, each field of them; nothing of Voltcam is in here."""

import dataclasses

from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, sequence, uint8, uint16, uint32, uint64


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
class Event(IdlStruct, typename="dvs_msgs.msg.dds_.Event_"):
    x_: uint16
    y_: uint16
    ts_: Time
    polarity_: bool


@dataclasses.dataclass
class EventArray(IdlStruct, typename="dvs_msgs.msg.dds_.EventArray_"):
    header_: Header
    height_: uint32
    width_: uint32
    events_: sequence[Event]


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


@dataclasses.dataclass
class CompressedImage(IdlStruct, typename="sensor_msgs.msg.dds_.CompressedImage_"):
    header_: Header
    format_: str
    data_: sequence[uint8]
