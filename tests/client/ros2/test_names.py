"""Names and places, as the environment of ROS 2 has them."""

import pytest

from voltcam_client.ros2 import Ros2Error
from voltcam_client.ros2.names import Ros2Place, dds_name, topic_name


@pytest.mark.parametrize("name", ["dvs", "/dvs", "_a/b_1/C"])
def test_names_are_made_whole(name: str) -> None:
    assert topic_name(name) == "/" + name.removeprefix("/")
    assert dds_name(name) == "rt/" + name.removeprefix("/")


@pytest.mark.parametrize(
    "name", ["", "/", "a//b", "a/", "1a", "a/2", "a-b", "a b", "ä", "~a", "a__b", "a" * 201]
)
def test_what_is_no_name(name: str) -> None:
    with pytest.raises(Ros2Error, match="is no name of ROS 2"):
        topic_name(name)


def test_places() -> None:
    assert Ros2Place.of({}) == Ros2Place(0, subnet=False)
    assert Ros2Place.of({"ROS_DOMAIN_ID": "", "ROS_AUTOMATIC_DISCOVERY_RANGE": ""}) == Ros2Place(
        0, subnet=False
    )
    said = {"ROS_DOMAIN_ID": "232", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    assert Ros2Place.of(said) == Ros2Place(232, subnet=True)
    assert not Ros2Place.of({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}).subnet


@pytest.mark.parametrize(
    ("key", "value"),
    [
        *(("ROS_DOMAIN_ID", value) for value in ("-1", "233", "a", "1.5", "²", "9" * 5000)),
        *(("ROS_AUTOMATIC_DISCOVERY_RANGE", value) for value in ("subnet", "OFF", "x" * 500)),
    ],
)
def test_what_is_no_place(key: str, value: str) -> None:
    with pytest.raises(Ros2Error, match=key) as caught:
        Ros2Place.of({key: value})
    assert len(str(caught.value)) < 200
