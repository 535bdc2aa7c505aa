"""`voltcam config check`: a file is read as `serve` would read it, and nothing is opened."""

from pathlib import Path

import pytest
import yaml

from voltcam_client.cli import main


def test_a_config_file_is_checked_before_it_is_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "voltcam.yaml"
    file.write_text("camera: davis240c\nsource: {uri: /none/such.mp4}")
    assert main(["config", "check", str(file)]) == 0
    said = capsys.readouterr().out
    assert "is well" in said
    assert "240 x 180" in said
    assert "not there now" in said
    file.write_text("camera: davis240c\nhttp: 0.0.0.0:8560")
    assert main(["config", "check", str(file)]) == 1
    assert "VOLTCAM_TOKEN" in capsys.readouterr().err
    file.write_text("camra: davis240c")
    assert main(["config", "check", str(file)]) == 1
    assert "camra: there is no such key" in capsys.readouterr().err


def test_a_config_of_several_is_checked_camera_by_camera(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "rig.yaml"
    cameras = {name: {"zmq": f"tcp://127.0.0.1:{5000 + len(name)}"} for name in ("left", "right")}
    file.write_text(yaml.safe_dump({"camera": "davis240c", "cameras": cameras}))
    assert main(["config", "check", str(file)]) == 0
    said = capsys.readouterr().out
    assert said.index("camera   left") < said.index("camera   right")
    assert "tcp://127.0.0.1:5005" in said


def checked(folder: Path, capsys: pytest.CaptureFixture[str], **content: object) -> str:
    file = folder / "voltcam.yaml"
    file.write_text(yaml.safe_dump(content))
    assert main(["config", "check", str(file)]) == 0
    return capsys.readouterr().out


def test_it_says_what_the_file_means(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    there = tmp_path / "walk.mp4"
    there.touch()
    said = checked(
        tmp_path, capsys, camera="paper", seed=7, source={"uri": str(there)},
        parameters={"leak_noise": {"k6": 0}},
    )  # fmt: skip
    (camera,) = [line for line in said.splitlines() if "camera   " in line]
    assert "paper, 346 x 260, seed 7: contrast_response, " in camera
    assert "leak_noise" not in camera
    assert f"source   {there}\n" in said
    assert "without a token" in said
    assert "without keys" in said


def test_secrets_are_not_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tokens = tmp_path / "tokens"
    tokens.write_text(f"control {'s' * 32}\n")
    tokens.chmod(0o600)
    said = checked(
        tmp_path, capsys, source={"uri": "rtsp://me:hidden@cam.local/"}, access={"tokens_file": str(tokens)}
    )
    assert "with tokens" in said
    assert "rtsp://me:***@cam.local/\n" in said  # a stream is not looked for
    assert "hidden" not in said
    assert "ssss" not in said


@pytest.mark.parametrize(
    "uri", ["scene", "ros1:/camera/image_raw", "ros2:/camera/image_raw", "rtsp://robot/front"]
)
def test_what_is_no_file_is_not_missed(uri: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = checked(tmp_path, capsys, source={"uri": uri}, udp="spif://127.0.0.1:3333")
    assert "not there now" not in said
    assert "UDP      spif://127.0.0.1:3333" in said
