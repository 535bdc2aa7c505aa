"""ROS 1 in the bench: its roscore, as far as a node needs one, and a bridge that does not come."""

import pytest

from voltcam_client.errors import VoltcamError
from voltcam_client.ros1.names import Names
from voltcam_client.ros1.node import Node
from voltcam_server.bench import ros1
from voltcam_server.bench.ros1 import Roscore


def test_a_node_publishes_there() -> None:
    roscore = Roscore()
    try:
        with Node(Names.of("one", [], {"ROS_MASTER_URI": roscore.uri, "ROS_HOSTNAME": "127.0.0.1"})) as node:
            node.advertise("/dvs/events", "event_camera_msgs/EventPacket", 1)
            assert roscore.publisher("/dvs/events", 0) == node.uri
    finally:
        roscore.close()


def test_nobody_who_publishes_is_said_in_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ros1.sys, "executable", "/bin/true")
    with pytest.raises(VoltcamError, match="nobody publishes /dvs/events within"):
        ros1.bridge("tcp://127.0.0.1:1", 0.1).__enter__()
