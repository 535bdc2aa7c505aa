"""The systemd unit, looked at by systemd itself where it is installed."""

import configparser
import re
import shutil
import subprocess
from pathlib import Path

import pytest

UNIT = Path(__file__).parents[2] / "docker" / "voltcam.service"
MOST_EXPOSED = 2.0  # of 10, as `systemd-analyze security` counts

analyze = pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd is not installed here")


def run(*words: str) -> str:
    done = subprocess.run(
        ["systemd-analyze", *words], capture_output=True, text=True, timeout=60, check=False
    )
    return done.stdout + done.stderr


@analyze
def test_systemd_finds_no_fault(tmp_path: Path) -> None:
    unit = tmp_path / UNIT.name
    unit.write_text(re.sub(r"/opt/voltcam/bin/voltcam", "/bin/true", UNIT.read_text()))  # it is not installed
    assert run("verify", str(unit)) == ""


@analyze
def test_it_is_hardened() -> None:
    said = run("security", "--offline=true", str(UNIT))
    found = re.search(r"Overall exposure level for \S+: ([\d.]+)", said)
    assert found, said
    assert float(found[1]) <= MOST_EXPOSED


def test_it_ends_lives_and_is_bounded_as_the_pages_say() -> None:
    unit = configparser.ConfigParser(interpolation=None, strict=False)
    unit.optionxform = str  # type: ignore[assignment,method-assign]
    unit.read(UNIT)
    service = unit["Service"]
    assert service["Type"] == "notify"
    assert int(service["WatchdogSec"]) >= 30  # more than any stall, once in a second is told
    assert {"MemoryMax", "TasksMax", "DynamicUser", "DeviceAllow"} <= set(service)
    assert service["ProtectSystem"] == "strict"
    assert "MemoryDenyWriteExecute" not in service  # kernels are compiled at run time
