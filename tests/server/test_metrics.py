"""Metrics as Prometheus' own parser reads them."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

from voltcam_server.emulator import Emulator
from voltcam_server.metrics import STATES, prometheus
from voltcam_server.status import Total
from voltcam_server.transports import TransportStatus
from voltcam_server.transports.transport import ClientStatus

from .rig import SCENE, Api, serving, tiny, until


@pytest.fixture(scope="module")
def api() -> Iterator[Api]:
    with serving() as api:
        yield api


def test_health_and_metrics(api: Api) -> None:
    base = f"http://{api.address}"
    assert httpx.get(f"{base}/healthz", trust_env=False).json() == {"status": "ok"}
    well = {"status": "running", "reason": ""}  # once a busy machine drops nothing any more
    until(lambda: httpx.get(f"{base}/readyz", trust_env=False).json() == well, "it is well")
    before = api.http.get("status").json()
    response = httpx.get(f"{base}/metrics", trust_env=False)
    after = api.http.get("status").json()
    assert response.headers["content-type"].startswith("text/plain; version=0.0.4")
    families = {family.name: family for family in text_string_to_metric_families(response.text)}
    value = {
        (sample.name, *(each for key, each in sample.labels.items() if key != "camera")): sample.value
        for family in families.values()
        for sample in family.samples
        if sample.labels.get("camera") == "tiny"
    }
    events = value["voltcam_events_total",]
    assert before["events"]["total"] <= events <= after["events"]["total"]
    assert value["voltcam_packets_sent_total", "listener"] > 0
    assert value["voltcam_state", "running"] == 1
    assert value["voltcam_state", "stalled"] == 0
    simulated = value["voltcam_stage_seconds_count", "simulating"]
    assert before["frames"]["simulated"] <= simulated + 1  # one may be counted and not yet timed
    assert simulated <= after["frames"]["received"]
    assert families["process_resident_memory_bytes"].samples[0].value > 1e6


def values(*cameras: tuple[str, dict[str, Any]]) -> dict[tuple[str, ...], float]:
    """Samples by name and the values of their labels, of cameras with these changes to their status."""
    running = [_camera(name, **changes) for name, changes in cameras]
    families = list(text_string_to_metric_families(prometheus(running)))  # type: ignore[arg-type]
    names = [family.name for family in families]
    assert len(names) == len(set(names))  # one family for all cameras
    return {
        (sample.name, *sample.labels.values()): sample.value
        for family in families
        for sample in family.samples
    }


def _camera(name: str, **changes: Any) -> SimpleNamespace:
    emulator = Emulator(tiny(), SCENE)
    emulator.stages.labels("simulating").observe(0.03)
    status = emulator.status.model_copy(update=changes)
    return SimpleNamespace(name=name, emulator=SimpleNamespace(status=status, histograms=emulator.histograms))


def test_each_camera_has_its_own_samples() -> None:
    found = values(
        ("left", {"events": Total(total=5, per_s=0)}), ("right", {"events": Total(total=7, per_s=0)})
    )
    assert found["voltcam_events_total", "left"] == 5
    assert found["voltcam_events_total", "right"] == 7
    assert found["voltcam_stage_seconds_count", "left", "simulating"] == 1
    assert found["voltcam_stage_seconds_sum", "right", "simulating"] == pytest.approx(0.03)
    assert found["voltcam_sent_age_seconds_count", "left"] == 0


@pytest.mark.parametrize("state", STATES)
def test_a_camera_is_in_one_state(state: str) -> None:
    found = values(("one", {"state": state}))
    states = {labels[2]: value for labels, value in found.items() if labels[0] == "voltcam_state"}
    assert states == {each: float(each == state) for each in STATES}


def test_units_are_those_of_the_names() -> None:
    """Prometheus counts in seconds; the status in microseconds and milliseconds."""
    latency = Emulator(tiny(), SCENE).status.latency.model_copy(update={"age_ms": 250.0})
    found = values(("one", {"skipped_us": 1_500_000, "latency": latency}))
    assert found["voltcam_skipped_seconds_total", "one"] == 1.5
    assert found["voltcam_age_seconds", "one"] == 0.25


def test_subscribers_are_counted_by_transport_and_topic() -> None:
    clients = [
        ClientStatus(address=f"h:{i}", topic=topic, encoding=None, sent=1, dropped=0)
        for i, topic in enumerate(("events", "events", "frames"))
    ]
    websocket = TransportStatus(address="w", packets_sent=9, packets_dropped=4, clients=clients)
    zeromq = TransportStatus(address="z", packets_sent=3, packets_dropped=0)
    found = values(("one", {"transports": {"websocket": websocket, "zeromq": zeromq}}))
    assert found["voltcam_clients", "one", "events", "websocket"] == 2
    assert found["voltcam_clients", "one", "frames", "websocket"] == 1
    assert found["voltcam_packets_sent_total", "one", "zeromq"] == 3
    assert found["voltcam_packets_dropped_total", "one", "websocket"] == 4
