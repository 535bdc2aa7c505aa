"""What systemd is told, over a socket of the test's."""

import socket
from pathlib import Path

import pytest

from voltcam_server.service import tell_systemd

from .process import Daemon


def test_systemd_hears_that_it_is_ready_and_lives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    address = tmp_path / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(str(address))
        systemd.settimeout(20)
        monkeypatch.setenv("NOTIFY_SOCKET", str(address))
        with Daemon() as daemon:
            heard = ""
            while "READY=1" not in heard or "WATCHDOG=1" not in heard or "running" not in heard:
                heard += systemd.recv(4096).decode()
            daemon.http.close()
            daemon.end()
            while "STOPPING=1" not in heard:
                heard += systemd.recv(4096).decode()


@pytest.mark.parametrize("abstract", [False, True])
def test_words_arrive_as_they_are(abstract: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a file's socket, or one of Linux's without a file, which systemd writes with an @."""
    name = f"@voltcam-{tmp_path.name}" if abstract else str(tmp_path / "notify")
    monkeypatch.setenv("NOTIFY_SOCKET", name)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as systemd:
        systemd.bind(name.replace("@", "\0") if abstract else name)
        systemd.settimeout(10)
        tell_systemd("STATUS=läuft")
        assert systemd.recv(100).decode() == "STATUS=läuft"


def test_nobody_there_does_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "gone"))
    tell_systemd("READY=1")
    monkeypatch.delenv("NOTIFY_SOCKET")
    monkeypatch.setattr(socket, "socket", lambda *_: pytest.fail("nobody asked"))
    tell_systemd("READY=1")
