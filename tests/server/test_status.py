"""Rates of a status, by a clock of the test's own, and what its JSON holds."""

import pytest

from voltcam_server import status as status_module
from voltcam_server.emulator import Emulator
from voltcam_server.status import Meter, Status, Total

from .rig import SCENE, tiny


class FakeTime:
    """A clock that stands."""

    now_s = 50.0

    def monotonic(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> FakeTime:
    time = FakeTime()
    monkeypatch.setattr(status_module, "time", time)
    return time


def test_a_rate_is_of_the_time_between_the_last_two_ticks(clock: FakeTime) -> None:
    meter = Meter()
    assert meter.status == Total(total=0, per_s=0)
    meter.total += 100
    clock.now_s += 2
    meter.tick()
    assert meter.status == Total(total=100, per_s=50)
    meter.total += 30
    assert meter.status == Total(total=130, per_s=50)  # until the next tick
    clock.now_s += 0.5
    meter.tick()
    assert meter.status == Total(total=130, per_s=60)
    clock.now_s += 1
    meter.tick()
    assert meter.status.per_s == 0


def test_two_ticks_at_one_time_divide_by_nothing(clock: FakeTime) -> None:
    meter = Meter()
    meter.total = 5
    meter.tick()
    assert meter.status == Total(total=5, per_s=0)
    clock.now_s += 1
    meter.tick()
    assert meter.status.per_s == 5


def test_a_status_survives_its_json() -> None:
    status = Emulator(tiny(), SCENE).status
    assert Status.model_validate_json(status.model_dump_json()) == status
    assert status.state == "starting"


def test_every_field_says_what_it_is() -> None:
    schema = Status.model_json_schema()
    for name, part in {"Status": schema, **schema["$defs"]}.items():
        for field, about in part.get("properties", {}).items():
            own = {"Status", "SourceStatus", "FrameCounts", "Total", "LatencyStatus", "Waiting"}
            assert name not in own or about.get("description"), (name, field)
