"""`voltcam keys`: keys made from the command line, and what is said of them."""

from pathlib import Path

import pytest
from tests.client.commands import assert_one_line

from voltcam_client import cli
from voltcam_client.keys import pair


def test_keys_of_the_camera_and_of_each_client(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "keys"
    assert cli.main(["keys", str(folder), "robot", "desk"]) == 0
    *clients, camera = capsys.readouterr().out.splitlines()
    assert camera.startswith(f"{folder}  (access.curve_keys")
    for line, name in zip(clients, ("robot", "desk"), strict=True):
        path, _, words = line.partition("  ")
        assert "VOLTCAM_KEYS" in words
        public, secret = pair(Path(path) / f"{name}.key_secret")
        assert len(public) == len(secret or b"") == 40


def test_without_names_only_the_camera_s(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["keys", str(tmp_path / "keys")]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1
    assert (tmp_path / "keys" / "camera.key_secret").exists()


def test_a_name_that_is_no_file_s_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["keys", str(tmp_path / "keys"), "../robot"]) == 1
    assert_one_line(capsys.readouterr().err)
    assert not list(tmp_path.rglob("*robot*"))
