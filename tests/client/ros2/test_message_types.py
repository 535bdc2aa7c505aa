"""Types as ROS 2 has them: fields and hashes against rosbags' own definitions."""

from typing import Any

import pytest

from voltcam_client.formats.ros_messages import register
from voltcam_client.ros2 import Ros2Error
from voltcam_client.ros2.message_types import FIELDS, HASHES, dds_type, library, structure

typesys = pytest.importorskip("rosbags.typesys", reason="rosbags, the oracle, is in the extra [lab]")


@pytest.fixture(params=["ROS2_HUMBLE", "ROS2_IRON", "ROS2_JAZZY"])
def store(request: pytest.FixtureRequest) -> Any:
    store = typesys.get_typestore(typesys.Stores[request.param])
    register(store, typesys)
    return store


@pytest.mark.parametrize("name", FIELDS)
def test_fields_are_those_of_ros2(store: Any, name: str) -> None:
    text, _ = store.generate_msgdef(name.replace("/", "/msg/"), ros_version=2)
    own = [line.split() for line in text.partition("=====")[0].splitlines()]
    fields = [(field, kind) for kind, field in (line for line in own if len(line) == 2)]
    assert fields == list(FIELDS[name].items())


@pytest.mark.parametrize("name", HASHES)
def test_hashes_are_those_of_ros2(store: Any, name: str) -> None:
    assert store.hash_rihs01(name.replace("/", "/msg/")) == f"RIHS01_{HASHES[name]}"


@pytest.mark.parametrize("name", HASHES)
def test_names_in_dds(name: str) -> None:
    pytest.importorskip("cyclonedds", reason="cyclonedds is in the extra [ros2]")
    package, _, short = name.partition("/")
    assert structure(name).__idl_typename__ == f"{package}.msg.dds_.{short}_"
    assert list(structure(name).__annotations__) == [f"{field}_" for field in FIELDS[name]]


def test_packed_bytes_go_through_untouched() -> None:
    pytest.importorskip("cyclonedds", reason="cyclonedds is in the extra [ros2]")
    kind = dds_type("sensor_msgs/Image")
    assert kind(b"anything").serialize(use_version_2=None) == b"anything"
    assert kind.deserialize(b"anything").cdr == b"anything"


def test_without_the_library_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(name: str, *args: Any) -> Any:
        raise ModuleNotFoundError(f"No module named {name!r}")

    monkeypatch.setattr("importlib.import_module", refuse)
    with pytest.raises(Ros2Error, match=r"pip install 'voltcam\[ros2\]'"):
        library("idl")
