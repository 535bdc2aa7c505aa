"""`voltcam doctor`: what works on this machine, each finding by itself and all of them by the command."""

import socket
from pathlib import Path

import numpy as np
import pytest
from tests.ports import free_port

from voltcam_client.cli import main
from voltcam_server import cli_doctor
from voltcam_server.cli_doctor import _devices, _findings, _port, _sizes, _speed, _udp
from voltcam_server.settings import Settings
from voltcam_simulator import Camera


def test_the_doctor_looks_at_ports_and_speed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cli_doctor, "TRY_S", 0.02)
    file = tmp_path / "voltcam.yaml"
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        file.write_text(f"{{camera: ideal, http: '127.0.0.1:{port}', zmq: 'tcp://127.0.0.1:{free_port()}'}}")
        assert main(["doctor", "--config", str(file)]) == 1
    said = capsys.readouterr().out
    assert f"127.0.0.1:{port}: Address already in use; choose another with --http" in said
    assert " 30 frames/s: up to " in said
    assert np.all([line[:4].strip() in ("ok", "no", "") for line in said.splitlines()])


@pytest.mark.parametrize("host", ["127.0.0.1", "", "[127.0.0.1]"])
def test_a_port_is_free_or_taken(host: str) -> None:
    port = free_port()
    assert _port(f"{host}:{port}", "--zmq") == (True, "port", f"{host}:{port} is free")
    with socket.create_server(("127.0.0.1", port)):
        good, _, words = _port(f"{host}:{port}", "--zmq")
    assert not good
    assert "Address already in use; choose another with --zmq" in words


@pytest.mark.parametrize(
    ("url", "good", "words"),
    [
        ("spif://127.0.0.1:3333", True, "can be sent to"),
        ("spif://[::1]:3333", True, "can be sent to"),
        ("t32_x16_y15_on1://no.such.host.invalid:3333", False, "choose another with --udp"),
    ],
)
def test_datagrams_need_a_host_that_there_is(url: str, good: bool, words: str) -> None:
    found, what, said = _udp(url)
    assert (found, what) == (good, "UDP")
    assert said.startswith(url)
    assert words in said


def test_foxglove_and_udp_are_named_where_they_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli_doctor, "_speed", lambda _: iter(()))
    port = free_port()
    settings = Settings(foxglove=f"127.0.0.1:{port}", udp="spif://127.0.0.1:3333")
    said = [words for _, _, words in _findings(settings)]
    assert f"127.0.0.1:{port} is free" in said
    assert [words for words in said if words.startswith("spif://127.0.0.1:3333 can")]
    assert not [words for _, _, words in _findings(Settings()) if "spif" in words or str(port) in words]


@pytest.mark.parametrize("address", ["127.0.0.1:http", "127.0.0.1:99999999", "no.such.host.invalid:80"])
def test_an_address_that_is_none_is_a_finding_and_no_error(address: str) -> None:
    good, what, words = _port(address, "--http")
    assert (good, what) == (False, "port")
    assert words.startswith(address)
    assert words.endswith("choose another with --http")


@pytest.mark.parametrize(
    ("pixels", "size"),
    [
        (128 * 128 - 1, "less than 128 x 128"),
        (128 * 128, "128 x 128"),
        (346 * 260, "346 x 260"),
        (1280 * 720 - 1, "640 x 480"),
        (1e12, "2560 x 1440"),
    ],
)
def test_the_largest_usual_sensor_of_so_many_pixels(pixels: float, size: str) -> None:
    assert _sizes(pixels) == size


def test_cameras_are_those_in_dev(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Path, "glob", lambda *_: iter([Path("/dev/video9"), Path("/dev/null")]))
    null, missing = _devices()
    assert (null[0], "can be opened" in null[2]) == (True, True)
    assert not missing[0]
    assert "/dev/video9 cannot be opened; sudo usermod -aG video" in missing[2]
    monkeypatch.setattr(Path, "glob", lambda *_: iter([]))
    ((good, _, words),) = _devices()
    assert good is None
    assert "the built-in scene" in words


@pytest.mark.parametrize(("frame_s", "own"), [(0.001, True), (0.1, False)])
def test_speed_is_the_share_of_a_core_that_a_frame_takes(
    frame_s: float, own: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So many times the camera's pixels: 0.7 of a core for the period, over the time of a frame."""
    monkeypatch.setattr(cli_doctor, "_frame_s", lambda *_: frame_s)
    camera = Camera.load("typical")
    findings = list(_speed(camera))[1:]
    assert [good for good, _, _ in findings] == [own, None, None]
    for (_, _, words), fps in zip(findings, (30, 60, 240), strict=True):
        assert words.startswith(f"{fps:>3} frames/s: up to {_sizes(0.7 / fps / frame_s * 346 * 260)};")
        assert words.endswith(f"346 x 260 takes {100 * fps * frame_s:.0f} % of a core")
