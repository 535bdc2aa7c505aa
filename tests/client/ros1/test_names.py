"""Names and remappings, as rospy resolves them."""

import pytest

from voltcam_client.ros1 import RosError
from voltcam_client.ros1.names import DEFAULT_MASTER, Names, bind_address


def test_without_anything_said() -> None:
    names = Names.of("voltcam", [], {})
    assert (names.node, names.master, names.host) == ("/voltcam", DEFAULT_MASTER, None)
    assert [names.resolved(name) for name in ("dvs/events", "/clock", "~a", "a//b/")] == [
        "/dvs/events",
        "/clock",
        "/voltcam/a",
        "/a/b",
    ]


def test_the_environment_and_arguments_over_it() -> None:
    env = {"ROS_NAMESPACE": "robot", "ROS_MASTER_URI": "http://a:1", "ROS_IP": "10.0.0.1"}
    names = Names.of("voltcam", [], env)
    assert (names.node, names.master, names.host) == ("/robot/voltcam", "http://a:1", "10.0.0.1")
    told = ["__ns:=/arm", "__name:=eye", "__master:=http://b:2", "__hostname:=me", "__log:=/tmp/a.log"]
    names = Names.of("voltcam", told, env)
    assert (names.node, names.master, names.host) == ("/arm/eye", "http://b:2", "me")
    assert names.resolved("dvs/events") == "/arm/dvs/events"


def test_topics_are_remapped() -> None:
    names = Names.of("voltcam", ["dvs/events:=events", "/arm/dvs/imu:=/imu", "__ns:=arm"], {})
    assert [names.resolved(f"dvs/{name}") for name in ("events", "imu", "image_raw")] == [
        "/arm/events",
        "/imu",
        "/arm/dvs/image_raw",
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("_rate:=5", "no private parameters"),
        ("dvs/events:=", "nothing follows"),
        ("dvs/events:=a-b", "'a-b' is no name"),
        ("0:=a", "'0' is no name"),
    ],
)
def test_what_is_wrong_is_said(text: str, words: str) -> None:
    with pytest.raises(RosError, match=words):
        Names.of("voltcam", [text], {})


def test_others_are_told_the_address_that_leads_to_the_roscore() -> None:
    assert Names.of("a", [], {"ROS_MASTER_URI": "http://127.0.0.1:11311"}).own_host() == "127.0.0.1"
    assert Names.of("a", [], {"ROS_HOSTNAME": "robot.local"}).own_host() == "robot.local"
    with pytest.raises(RosError, match=r"no way to a roscore at http://nobody.invalid:1"):
        Names.of("a", [], {"ROS_MASTER_URI": "http://nobody.invalid:1"}).own_host()


def test_a_node_of_this_machine_listens_here_only() -> None:
    assert bind_address("127.0.0.1") == bind_address("localhost") == "127.0.0.1"
    assert bind_address("10.0.0.1") == bind_address("robot.local") == ""
