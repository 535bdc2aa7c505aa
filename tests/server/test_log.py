"""What the daemon says by itself: a line for each change of state, rates, and words for systemd."""

import json
from pathlib import Path

from .process import Daemon
from .rig import moving_frames, save_frames, tiny, until


def test_a_source_that_ends_is_a_line(tmp_path: Path) -> None:
    uri = save_frames(tmp_path / "few.npz", moving_frames(20, tiny()), 100_000)
    daemon = Daemon("--source", uri)
    until(lambda: "WARNING ended: " in daemon.log, "its end is told")
    until(lambda: daemon.http.put("source", json={"uri": "scene"}).is_success, "another source")
    until(lambda: "INFO running: scene" in daemon.log, "the other is told")
    daemon.http.close()
    assert daemon.end()[:2] == (0, "")


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
