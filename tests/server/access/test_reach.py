"""The daemon on addresses beyond this machine, with keys, and under more connections than it takes."""

from pathlib import Path

import httpx
import pytest

from voltcam_client import EventCamera, VoltcamError
from voltcam_client.keys import make_keys
from voltcam_server.access import Tokens
from voltcam_server.access.reach import check_reach
from voltcam_server.problems import UsageError
from voltcam_server.settings import Settings

from ..process import Daemon, voltcam

LOOPBACK_ZMQ = ("--zmq", "tcp://127.0.0.1:0")


@pytest.mark.parametrize(
    ("arguments", "remedy"),
    [
        (("--http", "0.0.0.0:0", *LOOPBACK_ZMQ), "VOLTCAM_TOKEN"),
        (("--http", "[::]:0", *LOOPBACK_ZMQ), "VOLTCAM_TOKEN"),
        (("--http", "127.0.0.1:0", "--zmq", "tcp://0.0.0.0:0"), "voltcam keys"),
        (("--http", "127.0.0.1:0", "--zmq", "tcp://*:0"), "voltcam keys"),
        (("--http", "127.0.0.1:0", *LOOPBACK_ZMQ, "--dv", "0.0.0.0:0"), "ssh tunnel"),
        (("--http", "127.0.0.1:0", *LOOPBACK_ZMQ, "--foxglove", "0.0.0.0:0"), "ssh tunnel"),
        (("--http", "127.0.0.1:0", *LOOPBACK_ZMQ, "--source", "zmq+tcp://0.0.0.0:5570"), "ssh -L 5570"),
    ],
)
def test_an_open_address_without_a_token_is_refused_with_the_remedy(
    arguments: tuple[str, ...], remedy: str
) -> None:
    done = voltcam("serve", *arguments)
    assert done.returncode == 1
    assert remedy in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("http", ["127.0.0.1:1", "127.9.9.9:1", "[::1]:1", "localhost:1"])
def test_this_machine_needs_none(http: str) -> None:
    check_reach(Settings(http=http, zmq="ipc:///tmp/x"), Tokens([]))


def test_half_of_https_is_refused() -> None:
    with pytest.raises(UsageError, match="tls_key"):
        check_reach(Settings(access={"tls_certificate": "a.pem"}), Tokens([]))  # type: ignore[arg-type]


def test_the_banner_says_what_is_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VOLTCAM_TOKEN", "t" * 32)
    process = Daemon("--http", "0.0.0.0:0", ready=False)
    try:
        assert "http://0.0.0.0:" in process.banner
        url = process.url.replace("0.0.0.0", "127.0.0.1")
        assert httpx.get(f"{url}api/v1/status", trust_env=False).status_code == 401
    finally:
        assert process.end()[0] == 0


def test_keys_let_in_who_has_them(tmp_path: Path) -> None:
    (robot,) = make_keys(tmp_path / "keys", ["robot"])
    (stranger,) = make_keys(tmp_path / "others", ["stranger"])
    (stranger / "camera.key").write_bytes((robot / "camera.key").read_bytes())
    config = tmp_path / "voltcam.yaml"
    config.write_text(f"access: {{curve_keys: {tmp_path / 'keys'}}}\n")
    with Daemon("--config", str(config)) as daemon:
        with EventCamera(daemon.zmq, keys=robot) as camera:
            assert camera.receive(10) is not None
        for keys in (stranger, None):
            with EventCamera(daemon.zmq, keys=keys) as camera:
                assert camera.receive(1) is None


def test_keys_are_made_once_and_readable_by_their_owner(tmp_path: Path) -> None:
    (robot,) = make_keys(tmp_path, ["robot"])
    secret = (tmp_path / "camera.key_secret").read_bytes()
    make_keys(tmp_path, ["laptop"])
    assert (tmp_path / "camera.key_secret").read_bytes() == secret
    for file in (tmp_path / "camera.key_secret", robot / "robot.key_secret"):
        assert file.stat().st_mode & 0o077 == 0
    for name in ("robot", "../x", "camera", ""):
        with pytest.raises(VoltcamError):
            make_keys(tmp_path, [name])
    with pytest.raises(VoltcamError, match="folder of keys"):
        EventCamera(keys=tmp_path / "nowhere")
