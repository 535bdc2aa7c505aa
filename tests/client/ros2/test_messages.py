"""Messages of ROS 2, byte for byte as rosbags serialises them for Humble and Jazzy."""

from typing import Any

import numpy as np
import pytest

from voltcam_client.encodings import ENCODINGS
from voltcam_client.formats.ros_messages import register
from voltcam_client.intrinsics import Intrinsics
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
@pytest.mark.parametrize("count", [0, 1, 2, 77])
def test_an_array_of_events(store: Any, frame_id: str, count: int) -> None:
    events = np.zeros(count, EVENT)
    events["t"], events["x"], events["p"] = T_US + np.arange(count), np.arange(count), np.arange(count) % 2
    packet = Packet(
        events=events, width=346, height=260, seq=3, time_base_ns=1000 * T_US, stamp_ns=1, frame_id=frame_id
    )
    event, time = store.types["dvs_msgs/msg/Event"], store.types["builtin_interfaces/msg/Time"]
    expected = serialized(
        store,
        "dvs_msgs/msg/EventArray",
        header=header(store, T_US, frame_id),
        height=260,
        width=346,
        events=[
            event(x=x, y=y, ts=time(sec=t // 10**6, nanosec=t % 10**6 * 1000), polarity=p)
            for t, x, y, p in events[["t", "x", "y", "p"]].tolist()
        ],
    )
    assert messages.event_array(packet) == expected


@pytest.mark.parametrize("frame_id", UNALIGNED)
def test_a_calibrated_camera_info(store: Any, frame_id: str) -> None:
    image = np.zeros((5, 7), np.uint8)
    frame = FrameMessage(image=image, t_us=T_US, seq=3, stamp_ns=1, frame_id=frame_id)
    k, p = tuple(np.arange(9.0)), tuple(np.arange(12.0))
    intrinsics = Intrinsics((7, 5), "equidistant", (0.1, -0.2, 0.0, 1e-3), k, k[::-1], p)
    region = store.types["sensor_msgs/msg/RegionOfInterest"](
        x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
    )
    expected = serialized(
        store,
        "sensor_msgs/msg/CameraInfo",
        header=header(store, T_US, frame_id),
        height=5,
        width=7,
        distortion_model="equidistant",
        d=np.array(intrinsics.distortion),
        k=np.array(intrinsics.k),
        r=np.array(intrinsics.r),
        p=np.array(intrinsics.p),
        binning_x=0,
        binning_y=0,
        roi=region,
    )
    assert messages.camera_info(frame, intrinsics) == expected


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
    packet = Packet(events=np.zeros(0, EVENT), width=1, height=1, seq=0, time_base_ns=1000 * t_us, stamp_ns=1)
    with pytest.raises(Ros2Error, match="stamps from 0"):
        messages.event_array(packet)
    frame = FrameMessage(image=np.zeros((1, 1), np.uint8), t_us=2**31 * 1_000_000 - 1, seq=0, stamp_ns=1)
    assert messages.image(frame)
