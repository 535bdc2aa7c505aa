"""What the daemon says by itself: a line for each change of state, rates, and words for systemd."""

import json
import time
from pathlib import Path

from .rig import Daemon, moving_frames, save_frames, tiny, until


def test_a_source_that_ends_is_a_line(tmp_path: Path) -> None:
    uri = save_frames(tmp_path / "few.npz", moving_frames(20, tiny()), 100_000)
    daemon = Daemon("--source", uri)
    until(lambda: daemon.get("status")["state"] == "ended", "it ends")
    until(lambda: daemon.http.put("source", json={"uri": "scene"}).is_success, "another source")
    until(lambda: daemon.get("status")["state"] == "running", "it runs")
    time.sleep(1.5)  # the log looks once a second
    daemon.http.close()
    assert daemon.end()[:2] == (0, "")
    lines = daemon.log.splitlines()
    assert any("WARNING ended: " in line for line in lines)
    assert any("INFO running: scene" in line for line in lines)


def test_rates_as_json(tmp_path: Path) -> None:
    config = tmp_path / "voltcam.yaml"
    config.write_text("log: {format: json, rates_s: 0.5}")
    daemon = Daemon("--config", str(config))
    until(lambda: daemon.get("status")["uptime_s"] > 4, "some seconds pass")
    daemon.http.close()
    daemon.end()
    lines = [json.loads(line) for line in daemon.log.splitlines()]
    rates = [line for line in lines if "events_per_s" in line]
    assert rates
    assert rates[-1]["fps"] > 0
    assert rates[-1]["level"] == "info"
