"""Messages of ROS 2, byte for byte as rosbags serialises them for Humble and Jazzy."""

from typing import Any

import numpy as np
import pytest

from voltcam_client.encodings import ENCODINGS
from voltcam_client.formats.ros_messages import register
from voltcam_client.packet import EVENT, FrameMessage, Packet
from voltcam_client.ros2 import Ros2Error, messages
from voltcam_client.samples import IMU

typesys = pytest.importorskip("rosbags.typesys", reason="rosbags, the oracle, is in the extra [lab]")
T_US = 1_700_000_000_123_456
UNALIGNED = ["", "a", "ab", "abc", "davis346", "kamera_µ"]
"""Names of all lengths that the padding after them may depend on."""


@pytest.fixture(params=["ROS2_HUMBLE", "ROS2_JAZZY"])
def store(request: pytest.FixtureRequest) -> Any:
    store = typesys.get_typestore(typesys.Stores[request.param])
    register(store, typesys)
    return store


def header(store: Any, t_us: int, frame_id: str) -> Any:
    seconds, us = divmod(t_us, 1_000_000)
    stamp = store.types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=1000 * us)
    return store.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame_id)


def serialized(store: Any, kind: str, **fields: Any) -> bytes:
    return bytes(store.serialize_cdr(store.types[kind](**fields), kind))


@pytest.mark.parametrize("frame_id", UNALIGNED)
@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("count", [0, 1, 777])
def test_events(store: Any, frame_id: str, encoding: str, count: int) -> None:
    events = np.zeros(count, EVENT)
    events["t"], events["x"], events["y"] = T_US + np.arange(count), np.arange(count) % 346, 7
    packet = Packet(
        events=events,
        width=346,
        height=260,
        seq=2**40 + 1,
        time_base_ns=1000 * T_US,
        stamp_ns=1,
        frame_id=frame_id,
    )
    encoded = ENCODINGS[encoding].encode(events, T_US)
    expected = serialized(
        store,
        "event_camera_msgs/msg/EventPacket",
        header=header(store, T_US, frame_id),
        height=260,
        width=346,
        seq=2**40 + 1,
        time_base=1000 * T_US,
        encoding=encoding,
        is_bigendian=False,
        events=np.frombuffer(encoded, np.uint8),
    )
    assert messages.event_packet(packet, encoding, encoded) == expected


@pytest.mark.parametrize("frame_id", UNALIGNED)
def test_an_image_and_its_camera_info(store: Any, frame_id: str) -> None:
    image = np.random.default_rng(1).integers(0, 256, (5, 7), np.uint8)
    frame = FrameMessage(image=image, t_us=T_US, seq=3, stamp_ns=1, frame_id=frame_id)
    stamped = header(store, T_US, frame_id)
    expected = serialized(
        store,
        "sensor_msgs/msg/Image",
        header=stamped,
        height=5,
        width=7,
        encoding="mono8",
        is_bigendian=0,
        step=7,
        data=image.ravel(),
    )
    assert messages.image(frame) == expected
    region = store.types["sensor_msgs/msg/RegionOfInterest"](
        x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
    )
    expected = serialized(
        store,
        "sensor_msgs/msg/CameraInfo",
        header=stamped,
        height=5,
        width=7,
        distortion_model="",
        d=np.empty(0),
        k=np.zeros(9),
        r=np.zeros(9),
        p=np.zeros(12),
        binning_x=0,
        binning_y=0,
        roi=region,
    )
    assert messages.camera_info(frame) == expected


@pytest.mark.parametrize("frame_id", UNALIGNED)
def test_imu_in_si_units(store: Any, frame_id: str) -> None:
    samples = np.zeros(2, IMU)
    samples["t"] = T_US, T_US + 1000
    samples["accel_g"], samples["gyro_deg_s"] = (0.0, -1.0, 0.5), (180.0, 0.0, -90.0)
    vector, quaternion = (store.types[f"geometry_msgs/msg/{name}"] for name in ("Vector3", "Quaternion"))
    unknown = np.zeros(9)
    unknown[0] = -1
    for sample, made in zip(samples, messages.imu(samples, frame_id), strict=True):
        expected = serialized(
            store,
            "sensor_msgs/msg/Imu",
            header=header(store, int(sample["t"]), frame_id),
            orientation=quaternion(x=0.0, y=0.0, z=0.0, w=0.0),
            orientation_covariance=unknown,
            angular_velocity=vector(x=float(np.pi), y=0.0, z=float(-np.pi / 2)),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=vector(x=0.0, y=-9.80665, z=4.903325),
            linear_acceleration_covariance=np.zeros(9),
        )
        assert made == expected


@pytest.mark.parametrize("t_us", [-1, 2**31 * 1_000_000])
def test_times_without_a_stamp_are_refused(t_us: int) -> None:
    frame = FrameMessage(image=np.zeros((1, 1), np.uint8), t_us=t_us, seq=0, stamp_ns=1)
    with pytest.raises(Ros2Error, match="stamps from 0"):
        messages.image(frame)
    frame = FrameMessage(image=np.zeros((1, 1), np.uint8), t_us=2**31 * 1_000_000 - 1, seq=0, stamp_ns=1)
    assert messages.image(frame)
