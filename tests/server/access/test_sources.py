"""Which sources and streams may be named from the network."""

import os
from pathlib import Path

import pytest

from voltcam_server.access import AccessError, AccessSettings, SourceRules
from voltcam_server.access.sources import urlsplit_scheme
from voltcam_video import SourceRequest

RULES = SourceRules(AccessSettings(source_urls=["rtsp://good.local/*"]))
OWN = "rtsp://me:secret@mine.local/front"


@pytest.mark.parametrize(
    "uri",
    [
        "http://10.0.0.1/", "ftp://elsewhere/a.mp4", "tcp://127.0.0.1:4000?listen=1", "rtsp://good.local@evil/x",
        "file:/etc/passwd", "concat:a.mp4|b.mp4", "/etc/passwd", "/dev/fd/3", "/proc/self/fd/3", "/dev/stdin",
        "/dev/zero", "data:text/plain,x", "RTSP://good.local/x", "../secret.npz", "ros1:/camera/image_raw",
    ],
)  # fmt: skip
def test_sources_that_were_not_opened_to_the_network_are_refused(uri: str) -> None:
    with pytest.raises(AccessError) as refusal:
        RULES.allowed(SourceRequest(uri=uri), OWN)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    "uri", ["scene", "0", "/dev/video1", "rtsp://good.local/front", "rtsp://me:secret@mine.local/front"]
)
def test_sources_that_were_are_allowed(uri: str) -> None:
    assert RULES.allowed(SourceRequest(uri=uri), OWN).uri == uri


def test_a_recording_below_the_folders_is_resolved(tmp_path: Path) -> None:
    rules = SourceRules(AccessSettings(source_folders=[tmp_path]))
    assert rules.allowed(SourceRequest(uri="a.mp4"), "scene").uri == str(tmp_path.resolve() / "a.mp4")
    with pytest.raises(AccessError):
        rules.stream("tcp://elsewhere:5560")
    assert rules.stream("tcp://127.0.0.1:5561") == "tcp://127.0.0.1:5561"


def test_a_replay_s_recording_is_held_to_the_folders_too(tmp_path: Path) -> None:
    rules = SourceRules(AccessSettings(source_folders=[tmp_path]))
    allowed = rules.allowed(SourceRequest(uri="replay:walk.npz", loop=True), "scene")
    assert (allowed.uri, allowed.loop) == (f"replay:{tmp_path.resolve() / 'walk.npz'}", True)
    with pytest.raises(AccessError):
        rules.allowed(SourceRequest(uri="replay:../walk.npz"), "scene")


def test_photographs_are_held_to_the_folders_too(tmp_path: Path) -> None:
    rules = SourceRules(AccessSettings(source_folders=[tmp_path]))
    allowed = rules.allowed(SourceRequest(uri="photos:mine?seed=3"), "scene")
    assert allowed.uri == f"photos:{tmp_path.resolve() / 'mine'}?seed=3"
    with pytest.raises(AccessError):
        rules.allowed(SourceRequest(uri="photos:../mine"), "scene")


def test_a_pipe_in_a_folder_is_no_recording(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "frames").mkdir()
    rules = SourceRules(AccessSettings(source_folders=[tmp_path]))
    assert rules.path("frames") == tmp_path.resolve() / "frames"
    with pytest.raises(AccessError, match="'pipe' is neither a file nor a folder"):
        rules.path("pipe")


def test_a_device_needs_a_pattern() -> None:
    rules = SourceRules(AccessSettings(source_devices=["/dev/video2"]))
    assert rules.allowed(SourceRequest(uri="2"), "scene").uri == "2"
    with pytest.raises(AccessError, match=r"'/dev/video0'.*add it to access\.source_devices"):
        rules.allowed(SourceRequest(uri="0"), "scene")


def test_what_the_operator_named_may_be_asked_for_as_it_is_shown() -> None:
    """The page shows it without its password, and asks for that."""
    rules = SourceRules(AccessSettings())
    own = "rtsp://me:***@mine.local/front"
    assert rules.allowed(SourceRequest(uri=OWN), own).uri == OWN
    with pytest.raises(AccessError):
        rules.allowed(SourceRequest(uri=OWN), "rtsp://other.local/")


def test_a_star_does_not_swallow_a_host_unless_the_pattern_says_so() -> None:
    rules = SourceRules(AccessSettings(source_urls=["rtsp://good.local*", "rtsp://u:p@cam.local/*"]))
    for uri in ("rtsp://u:p@cam.local/1", "rtsp://good.local:554/1"):
        assert rules.allowed(SourceRequest(uri=uri), "scene").uri == uri
    for uri in ("rtsp://good.local@evil/", "rtsp://u:p@cam.local@evil/"):
        with pytest.raises(AccessError):
            rules.allowed(SourceRequest(uri=uri), "scene")


def test_streams_are_those_of_this_machine_by_default() -> None:
    rules = SourceRules(AccessSettings())
    for address in ("tcp://127.0.0.1:5561", "tcp://localhost:1", "ipc:///run/voltcam"):
        assert rules.stream(address) == address
    for address in ("tcp://10.0.0.1:5561", "tcp://127.0.0.1.evil:1", "udp://127.0.0.1:1"):
        with pytest.raises(AccessError, match=r"access\.streams"):
            rules.stream(address)


@pytest.mark.parametrize(
    ("uri", "is_one"),
    [("concat:a|b", True), ("file:x", True), ("a.mp4", False), ("deep/a:b.mp4", False), ("C:a", True)],
)
def test_a_colon_before_any_slash_may_be_a_protocol(uri: str, is_one: bool) -> None:
    assert urlsplit_scheme(uri) == is_one
