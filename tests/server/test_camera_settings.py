"""What one camera is told: frames between frames, packets, encodings, and the camera itself."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from voltcam_client.encodings import ENCODINGS
from voltcam_server.camera_settings import (
    MOST_UPSAMPLE_STEPS,
    CameraSettings,
    PacketSettings,
    check_encoding,
    load_camera,
)
from voltcam_server.problems import UsageError
from voltcam_server.settings import load
from voltcam_simulator import Camera


def test_an_encoding_must_hold_the_camera() -> None:
    check_encoding("evt3", 2048, 2048)
    with pytest.raises(UsageError, match="evt3 holds x below 2048"):
        check_encoding("evt3", 4000, 100)


def test_changes_keep_what_the_camera_file_says(tmp_path: Path) -> None:
    camera = tmp_path / "mine.yaml"
    camera.write_text("name: mine\nwidth: 32\nheight: 20\ncomparator: {theta_on: 2.0}\n")
    settings = load({"camera": str(camera), "parameters": {"comparator": {"theta_off": 3}}}, None, {})
    loaded = settings.load_camera()
    assert (loaded.width, loaded.parameters.comparator.theta_on) == (32, 2.0)
    assert loaded.parameters.comparator.theta_off == 3.0


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("width: -1\nheight: 4", "width: Input should be greater than or equal to 1, not -1"),
        ("comparator: {theta_on: 0}", "comparator.theta_on: "),
        ("shutter: {}", "shutter: there is no such key"),
        ("[]", "is not a camera file"),
    ],
)
def test_faults_in_a_camera_file(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(content)
    with pytest.raises(UsageError) as caught:
        load_camera(str(path))
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("given", "taken"),
    [("off", "off"), (False, "off"), ("linear", "linear"), ("cubic", "cubic"), ("auto", "auto"), (1, 1),
     ("8", 8), (MOST_UPSAMPLE_STEPS, MOST_UPSAMPLE_STEPS)],
)  # fmt: skip
def test_ways_to_frames_between_frames(given: Any, taken: Any) -> None:
    assert CameraSettings(upsample=given).upsample == taken


@pytest.mark.parametrize("given", [True, 0, -1, MOST_UPSAMPLE_STEPS + 1, "65", "on", "", None, 2.5, [2]])
def test_other_ways_are_refused_with_all_there_are(given: Any) -> None:
    with pytest.raises(
        ValidationError, match="give off, linear, cubic, auto or a number of steps from 1 to 64"
    ):
        CameraSettings(upsample=given)


@given(st.integers(8, 2**24))
def test_a_packet_holds_the_events_of_its_bytes(packet_bytes: int) -> None:
    events = PacketSettings(packet_bytes=packet_bytes).packet_events
    assert events >= 1
    assert 8 * events <= packet_bytes < 8 * (events + 1)


@pytest.mark.parametrize("wrong", [{"packet_us": 99}, {"packet_us": 1001}, {"packet_bytes": 7}, {"pace": 1}])
def test_packets_have_limits(wrong: dict[str, int]) -> None:
    with pytest.raises(ValidationError, match=next(iter(wrong))):
        PacketSettings.model_validate(wrong)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_an_encoding_is_held_against_the_last_pixel(encoding: str) -> None:
    width, height = {"libcaer": (1 << 15, 1 << 15), "mono": (1 << 16, 1 << 15)}.get(encoding, (2048, 2048))
    check_encoding(encoding, width, height)
    with pytest.raises(UsageError, match=f"{encoding} holds x below .* y below"):
        check_encoding(encoding, width, height + 1)


def test_an_unknown_encoding_lists_the_known_ones() -> None:
    with pytest.raises(UsageError, match="unknown encoding 'morse': give one of libcaer, mono, evt3"):
        check_encoding("morse", 10, 10)


@pytest.mark.parametrize("zmq", ["tcp://127.0.0.1:0", "ipc:///run/voltcam"])
def test_endpoints(zmq: str) -> None:
    assert CameraSettings(zmq=zmq).zmq == zmq


@pytest.mark.parametrize("zmq", ["127.0.0.1:5560", "udp://127.0.0.1:1", "tcp://", "tcp://a b"])
def test_endpoints_that_are_none(zmq: str) -> None:
    with pytest.raises(ValidationError, match="zmq"):
        CameraSettings(zmq=zmq)


@pytest.mark.parametrize(
    ("dv", "taken"),
    [("127.0.0.1:7777", "127.0.0.1:7777"), ("[::1]:0", "[::1]:0"), ("off", "off"), (False, "off")],
)
def test_dv_addresses(dv: Any, taken: str) -> None:
    assert CameraSettings(dv=dv).dv == taken


@pytest.mark.parametrize("dv", ["banana", "7777", "tcp://127.0.0.1:7777", True, 7777])
def test_dv_addresses_that_are_none(dv: Any) -> None:
    with pytest.raises(ValidationError, match=r"give HOST:PORT, such as 127\.0\.0\.1:7777, or off"):
        CameraSettings(dv=dv)


def test_four_ports_are_needed() -> None:
    assert CameraSettings(dv="127.0.0.1:65532").dv
    with pytest.raises(ValidationError, match="take 4 ports, and none is above 65535"):
        CameraSettings(dv="127.0.0.1:65533")


def test_a_camera_is_a_name_or_a_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(Camera.load("paper").to_yaml())
    assert load_camera(str(path)) == load_camera("paper") == Camera.load("paper")
    with pytest.raises(UsageError, match=r"none\.yaml cannot be read: No such file or directory: check the"):
        load_camera("none.yaml")
    with pytest.raises(UsageError, match="unknown camera 'leica'"):
        load_camera("leica")


@pytest.mark.parametrize("udp", ["spif://127.0.0.1:3333", "t32_x16_y15_on1://[::1]:9", "off", False])
def test_udp_addresses(udp: Any) -> None:
    assert CameraSettings(udp=udp).udp == (udp or "off")


@pytest.mark.parametrize("udp", ["127.0.0.1:3333", "es://127.0.0.1:1", "spif://h:0", "spif://h:65536", True])
def test_udp_addresses_that_are_none(udp: Any) -> None:
    with pytest.raises(ValidationError, match=r"give spif://HOST:PORT, t32_x16_y15_on1://HOST:PORT, or off"):
        CameraSettings(udp=udp)


def test_foxglove_addresses() -> None:
    assert CameraSettings(foxglove="127.0.0.1:65535").foxglove == "127.0.0.1:65535"
    for wrong in ("127.0.0.1:65536", "banana", "ws://127.0.0.1:8765", True):
        with pytest.raises(ValidationError, match=r"give HOST:PORT, such as 127\.0\.0\.1:8765, or off"):
            CameraSettings(foxglove=wrong)
