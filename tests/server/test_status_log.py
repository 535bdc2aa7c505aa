"""What of a camera's status goes to the log: what is new, and rates now and then."""

from typing import Any

import pytest

from voltcam_server import status_log
from voltcam_server.emulator import Emulator
from voltcam_server.log import LogSettings
from voltcam_server.recorder import RecordingStatus
from voltcam_server.status import Status
from voltcam_server.status_log import StatusLog

from .rig import SCENE, emulating, tiny, until


def test_a_recording_that_fails_is_a_line(caplog: pytest.LogCaptureFixture) -> None:
    """A full disk: nothing was in any log."""
    with emulating(SCENE) as (emulator, _):
        until(lambda: emulator.status.state == "running", "it runs")
        status = emulator.status
    recording = RecordingStatus(
        path="a.npz",
        recording=False,
        ending=False,
        files=1,
        events=5,
        frames=1,
        lost_intervals=0,
        left_out="",
        error="a.npz: No space left",
    )
    log = StatusLog(LogSettings())
    with caplog.at_level("INFO", "voltcam"):
        for each in (status, status.model_copy(update={"recording": recording}), status):
            log.look(each)
            log.look(each)
    assert [record.getMessage() for record in caplog.records] == ["recording: a.npz: No space left"]


class FakeTime:
    """A clock that stands."""

    now_s = 50.0

    def monotonic(self) -> float:
        return self.now_s


def status(**changes: Any) -> Status:
    """Of a camera that has not begun, with what is changed."""
    now = Emulator(tiny(), SCENE).status
    source = now.source.model_copy(update={"uri": changes.pop("uri", "scene")})
    return now.model_copy(update={"source": source, "reason": "", **changes})


def told(caplog: pytest.LogCaptureFixture, statuses: list[Status], camera: str = "") -> list[tuple[str, str]]:
    log = StatusLog(LogSettings(rates_s=0), camera)
    with caplog.at_level("INFO", "voltcam"):
        for each in statuses:
            log.look(each)
    return [(record.levelname, record.getMessage()) for record in caplog.records]


def test_a_change_of_state_or_source_is_a_line_once(caplog: pytest.LogCaptureFixture) -> None:
    lost = status(state="source lost", reason="rtsp://cam/: it stalled", uri="rtsp://cam/")
    back = status(state="running", uri="rtsp://cam/")
    states = [status(state="running"), back, back, lost, lost, back, status(state="running", uri="a.mp4")]
    assert told(caplog, states) == [
        ("INFO", "running: rtsp://cam/"),
        ("WARNING", "source lost: rtsp://cam/: it stalled"),
        ("INFO", "running: rtsp://cam/"),
        ("INFO", "running: a.mp4"),
    ]


def test_a_bad_beginning_is_a_line_and_a_good_one_is_on_the_banner(caplog: pytest.LogCaptureFixture) -> None:
    assert told(caplog, [status(state="running")]) == []
    assert told(caplog, [status(state="overloaded", reason="too many events")]) == [
        ("WARNING", "overloaded: too many events")
    ]


def test_of_several_cameras_each_line_says_which(caplog: pytest.LogCaptureFixture) -> None:
    assert told(caplog, [status(state="ended", reason="a.mp4 is over")], "left") == [
        ("WARNING", "left: ended: a.mp4 is over")
    ]
    assert caplog.records[0].__dict__["camera"] == "left"
    assert caplog.records[0].__dict__["state"] == "ended"


@pytest.mark.parametrize(("rates_s", "lines"), [(0, 0), (10, 3)])
def test_rates_are_told_as_often_as_asked(
    rates_s: float, lines: int, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = FakeTime()
    monkeypatch.setattr(status_log, "time", clock)
    log, now = StatusLog(LogSettings(rates_s=rates_s)), status(state="running", load=0.25)
    with caplog.at_level("INFO", "voltcam"):
        for _ in range(35):
            clock.now_s += 1
            log.look(now)
    assert len(caplog.records) == lines
    for record in caplog.records:
        assert "load=0.25 " in record.getMessage()
        assert record.__dict__["load"] == 0.25
