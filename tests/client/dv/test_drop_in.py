"""Programs of dv-processing, unmodified, on a running emulator."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.server.process import Daemon, voltcam_path

pytest.importorskip("dv_processing", reason="dv-processing is not installed")

ALGORITHMS = str(Path(__file__).with_name("algorithms.py"))
LIMIT_S = 120

FINDS = """
import sys
import dv_processing as dv

(found,) = dv.io.camera.discover()
assert (found.serialNumber, found.cameraModel) == ("EMU00001", dv.io.camera.CameraModel.DAVIS)
for camera in (
    dv.io.camera.open(),
    dv.io.camera.open("EMU00001"),
    dv.io.camera.open(found),
    dv.io.camera.open(serialNumber="EMU00001", deviceLogLevel=dv.io.camera.USBDevice.LogLevel.LVL_INFO),
    dv.io.camera.openSync(found),
    dv.io.camera.DAVIS(),
    dv.io.CameraCapture(),
    dv.io.CameraCapture(dv.io.discoverDevices()[0]),
):
    assert camera.getCameraName() == "DAVIS346_EMU00001"
    assert isinstance(camera, dv.io.camera.DAVIS)
    assert camera.isRunning()
for given, named in ((("00000999",), {}), ((), {"serialNumber": "00000999"})):
    try:
        dv.io.camera.open(*given, **named)
    except RuntimeError as error:
        assert "no camera 00000999" in str(error)
    else:
        raise AssertionError
assert sys.argv[1:] == ["--window", "5"]
"""

READS = """
import datetime
import dv_processing as dv

camera = dv.io.camera.open()
assert (camera.getEventResolution(), camera.getFrameResolution()) == ((346, 260), (346, 260))
assert camera.isEventStreamAvailable() and camera.isFrameStreamAvailable()
assert camera.isTriggerStreamAvailable() and camera.isImuStreamAvailable()
assert camera.getImuModel() == dv.io.camera.imu.ImuModel.IMU_INVENSENSE_6500_9250
camera.setExposureDuration(datetime.timedelta(milliseconds=5))
assert camera.getExposureDuration() == datetime.timedelta(milliseconds=5)
camera.setDavis346BiasCoarseFine(dv.io.camera.DAVIS.Davis346BiasCF.LocalBuffer, 5, 164)
assert camera.getDavis346BiasCoarseFine(dv.io.camera.DAVIS.Davis346BiasCF.LocalBuffer) == (5, 164)

by_name, by_any = set(), set()
names = ("getNextEventBatch", "getNextFrame", "getNextTriggerBatch", "getNextImuBatch")
while len(by_name) < 4:
    for name in names:
        if getattr(camera, name)() is not None:
            by_name.add(name)
while len(by_any) < 4:
    data = camera.readNext()
    if data != dv.io.DataReadHandler.OutputFlag.CONTINUE:
        by_any.add(type(data).__name__)
"""


@pytest.fixture(scope="module")
def daemon() -> Iterator[Daemon]:
    with Daemon("--dv", "127.0.0.1:0", "--frames", "aps", "--imu", "1000", "--triggers", "100") as daemon:
        yield daemon


def run(address: str, *program: str, folder: Path) -> "subprocess.CompletedProcess[str]":
    command = [voltcam_path(), "dv", "run", "--dv", address, *program]
    return subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, cwd=folder, check=False)


def address(daemon: Daemon) -> str:
    return str(daemon.get("camera")["dv"])


def test_what_finds_and_opens_cameras_answers_with_the_emulator(daemon: Daemon, tmp_path: Path) -> None:
    (tmp_path / "finds.py").write_text(FINDS)
    done = run(address(daemon), "finds.py", "--window", "5", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_all_streams_are_read_and_settings_are_kept_without_effect(daemon: Daemon, tmp_path: Path) -> None:
    (tmp_path / "reads.py").write_text(READS)
    done = run(address(daemon), "reads.py", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr.splitlines() == [
        "voltcam: setExposureDuration has no effect on the emulator",
        "voltcam: the bias LocalBuffer has no effect on the emulator",
    ]


def test_real_algorithms_on_the_stream_and_on_its_recording(daemon: Daemon, tmp_path: Path) -> None:
    """Noise filter, Arc* corners, feature tracker and accumulator; the file gives the same."""
    done = run(address(daemon), ALGORITHMS, "300000", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    live: dict[str, Any] = json.loads(done.stdout)
    command = [sys.executable, ALGORITHMS, "300000", "camera.aedat4"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, cwd=tmp_path, check=True)
    recorded = json.loads(done.stdout)
    assert live == recorded
    assert live["name"] == "DAVIS346_EMU00001"
    assert 0.1 * live["all"] < live["kept"] < live["all"]
    assert live["corners"] > 100
    assert live["tracks"] > 0
    assert live["contrast"] > 1


SETS = """
import dv_processing as dv

Bias = dv.io.camera.DAVIS.Davis346BiasCF
camera = dv.io.camera.open()
usual = [camera.getDavis346BiasCoarseFine(bias) for bias in (Bias.On, Bias.Refractory)]
assert usual == [(6, 200), (4, 25)], usual
camera.setDavis346BiasCoarseFine(Bias.On, 6, 90)
camera.setDavis346BiasCoarseFine(Bias.Refractory, 5, 25)
assert camera.getDavis346BiasCoarseFine(Bias.On) == (6, 90)
"""


def test_biases_are_set_at_the_daemon(daemon: Daemon, tmp_path: Path) -> None:
    before = daemon.get("parameters")["parameters"]
    (tmp_path / "sets.py").write_text(SETS)
    done = run(address(daemon), "--url", daemon.url, "sets.py", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    after = daemon.get("parameters")["parameters"]
    assert after["comparator"]["theta_on"] < before["comparator"]["theta_on"]
    dead_us = before["refractory_period"]["period_us"]
    assert after["refractory_period"]["period_us"] == pytest.approx(dead_us / 8)


def test_without_its_daemon_no_bias_is_set(daemon: Daemon, tmp_path: Path) -> None:
    (tmp_path / "sets.py").write_text(SETS)
    done = run(address(daemon), "--url", "http://127.0.0.1:9", "sets.py", folder=tmp_path)
    assert done.returncode == 1
    assert "RuntimeError: no bias could be read: cannot reach http://127.0.0.1:9" in done.stderr


def test_without_a_daemon_it_says_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("")
    done = run("127.0.0.1:9", "a.py", folder=tmp_path)
    assert done.returncode == 1
    assert done.stderr == (
        "voltcam: no DV streams at 127.0.0.1:9: start `voltcam serve`, or give --dv HOST:PORT\n"
    )


def test_a_program_that_is_not_there(tmp_path: Path) -> None:
    done = run("127.0.0.1:9", "none.py", folder=tmp_path)
    assert (done.returncode, done.stderr) == (
        1, "voltcam: none.py cannot be run: there is no such file\n"
    )  # fmt: skip
