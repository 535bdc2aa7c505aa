"""The page on ROS 2: its subscriber, set up as it says, reads events of a daemon."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from tests.docs.blocks import DOCS, blocks
from tests.ros2 import own_namespace
from tests.server.process import Daemon

pytest.importorskip("cyclonedds", reason="cyclonedds is in the extra [ros2]")
PAGE = DOCS / "how-to" / "ros-2.md"


def test_the_subscriber_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "0")
    texts = {block.language: block.text for block in blocks(PAGE)}
    namespace = own_namespace()
    xml = re.search(r"```xml\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert xml is not None
    (tmp_path / "loopback.xml").write_text(xml[1])
    program = texts["python"].replace("rt/dvs/", f"rt/{namespace}/")
    environment = os.environ | {"CYCLONEDDS_URI": f"file://{tmp_path}/loopback.xml"}
    with Daemon("--dv", "off", "--ros2", namespace):
        done = subprocess.run(
            [sys.executable, "-c", program],
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.splitlines()[-1].split()[1]) > 0
