"""Types of messages, beside those that genpy generates and that the distribution has."""

import json

import pytest
from tests.roscore import Ros1, needs_ros1

from voltcam_client.ros1.message_types import message_type

NAMES = (
    "std_msgs/Header",
    "geometry_msgs/Quaternion",
    "geometry_msgs/Vector3",
    "rosgraph_msgs/Clock",
    "sensor_msgs/Image",
    "sensor_msgs/CompressedImage",
    "sensor_msgs/RegionOfInterest",
    "sensor_msgs/CameraInfo",
    "sensor_msgs/Imu",
    "event_camera_msgs/EventPacket",
    "dvs_msgs/Event",
    "dvs_msgs/EventArray",
)


@needs_ros1
def test_sums_and_definitions_are_those_of_ros(ros1: Ros1) -> None:
    """genpy computes the sum of its own definition, and that of the one which is sent along."""
    definitions = {name: message_type(name).definition for name in NAMES}
    peer = ros1.peer("sums")
    output, error = peer.communicate(json.dumps(definitions), timeout=30)
    assert not error
    for name, (sum_, of_ours, same_fields) in json.loads(output).items():
        assert message_type(name).md5 == sum_ == of_ours
        assert same_fields


def test_sums_that_anyone_can_look_up() -> None:
    assert message_type("std_msgs/Header").md5 == "2176decaecbce78abc3b96ef049fabed"
    assert message_type("sensor_msgs/Image").md5 == "060021388200f6f0f447d0fcd9c64743"
    assert message_type("dvs_msgs/EventArray").md5 == "5e8beee5a6c107e504c2e78903c224b8"


def test_a_type_that_is_none() -> None:
    with pytest.raises(KeyError):
        message_type("sensor_msgs/PointCloud2")
