"""Names from the network, and what they may mean."""

from pathlib import Path

import pytest

from voltcam_server.access import AccessError, AccessSettings, SourceRules, resolve_under
from voltcam_video import SourceRequest


@pytest.mark.parametrize(
    "name",
    [
        "../out.npz",
        "/etc/passwd",
        "a/../../out.npz",
        "a\0.npz",
        "x" * 300 + ".npz",
        "link/out.npz",
        "~root/a",
    ],
)
def test_what_leads_outside_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    inside = tmp_path / "in"
    inside.mkdir()
    (inside / "link").symlink_to(tmp_path)
    if name == "~root/a":
        assert resolve_under([inside], name) == inside / name  # a name like another: no shell is asked
        return
    with pytest.raises(AccessError) as refusal:
        resolve_under([inside], name)
    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 200


@pytest.mark.parametrize("name", ["a.npz", "deep/er/a.npz", "./a.npz", "deep/../a.npz"])
def test_what_is_below_is_allowed(name: str, tmp_path: Path) -> None:
    assert resolve_under([tmp_path], name) == (tmp_path / name).resolve()
    assert resolve_under([Path("/nowhere"), tmp_path], str(tmp_path / name)) == (tmp_path / name).resolve()


RULES = SourceRules(AccessSettings(source_urls=["rtsp://good.local/*"]))
OWN = "rtsp://me:secret@mine.local/front"


@pytest.mark.parametrize(
    "uri",
    [
        "http://10.0.0.1/", "ftp://elsewhere/a.mp4", "tcp://127.0.0.1:4000?listen=1", "rtsp://good.local@evil/x",
        "file:/etc/passwd", "concat:a.mp4|b.mp4", "/etc/passwd", "/dev/fd/3", "/proc/self/fd/3", "/dev/stdin",
        "/dev/zero", "data:text/plain,x", "RTSP://good.local/x", "../secret.npz",
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
