"""What the daemon says about itself, in Prometheus' text format, by camera."""

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

from prometheus_client import CollectorRegistry, ProcessCollector, generate_latest
from prometheus_client.metrics_core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from .cameras import Cameras
from .status import Status

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
STATES = ("starting", "running", "overloaded", "stalled", "source lost", "ended")
Sample = tuple[tuple[str, ...], float]


def prometheus(cameras: Cameras) -> str:
    """All of it. Counters end in _total; all names of ours start with voltcam_."""
    registry = CollectorRegistry()
    registry.register(_Cameras(cameras))
    ProcessCollector(registry=registry)  # memory, processor time, open files
    return generate_latest(registry).decode()


class _Cameras(Collector):
    def __init__(self, cameras: Cameras) -> None:
        self._cameras = cameras

    def collect(self) -> Iterator[Metric]:
        """One family of samples for each thing, with those of all cameras in it."""
        families: dict[str, Metric] = {}
        for camera in self._cameras:
            for metric in _of(camera.emulator.status):
                _merge(families, metric, camera.name)
            for histogram in camera.emulator.histograms:
                for metric in histogram.collect():
                    _merge(families, metric, camera.name)
        return iter(families.values())


def _merge(families: dict[str, Metric], metric: Metric, camera: str) -> None:
    family = families.setdefault(metric.name, Metric(metric.name, metric.documentation, metric.type))
    for sample in metric.samples:
        family.samples.append(sample._replace(labels={"camera": camera, **sample.labels}))


def _of(status: Status) -> Iterator[Metric]:
    frames, transports = status.frames, status.transports.items()
    clients = Counter((name, client.topic) for name, each in transports for client in each.clients)
    yield _gauge("state", "1 for the state the camera is in", _one_hot(status.state), ["state"])
    yield _gauge("load", "time of simulating beside the time it is for", status.load)
    yield _count("stalls", "times that no interval was finished for seconds", status.stalls)
    yield _count("skipped_seconds", "stream time left out", status.skipped_us / 1e6)
    yield _gauge("age_seconds", "age of what is being sent", status.latency.age_ms / 1000)
    yield _gauge("source_up", "1 while the source gives frames", status.source.state == "running")
    yield _gauge("source_fps", "frames from the source per second", status.source.fps)
    yield _count("frames_received", "frames from the source", frames.received)
    fates = [((fate,), count) for fate, count in frames.model_dump(exclude={"received"}).items()]
    yield _count("frames", "frames from the source, by what became of them", fates, ["fate"])
    yield _count("events", "events sent off", status.events.total)
    yield _count("packets", "event packets sent off", status.packets.total)
    sent = [((name,), each.packets_sent) for name, each in transports]
    yield _count("packets_sent", "event packets sent to subscribers", sent, ["transport"])
    dropped = [((name,), each.packets_dropped) for name, each in transports]
    yield _count("packets_dropped", "event packets dropped for slow ones", dropped, ["transport"])
    known = list(clients.items())
    yield _gauge("clients", "subscribers that the transport knows", known, ["transport", "topic"])
    waiting = [((queue,), count) for queue, count in status.waiting.model_dump().items()]
    yield _gauge("waiting", "what waits in a queue", waiting, ["queue"])
    yield _gauge("parameters_version", "changes of parameters", status.parameters_version)
    recording = status.recording
    yield _gauge("recording", "1 while recording", recording is not None and recording.recording)
    yield _count("recording_errors", "recordings that ended by an error", status.recording_errors)
    yield _gauge("uptime_seconds", "since the camera started", status.uptime_s)


def _one_hot(state: str) -> list[Sample]:
    return [((each,), float(each == state)) for each in STATES]


def _gauge(name: str, meaning: str, value: Any, labels: Iterable[str] = ()) -> Metric:
    return _filled(GaugeMetricFamily(f"voltcam_{name}", meaning, labels=list(labels)), value)


def _count(name: str, meaning: str, value: Any, labels: Iterable[str] = ()) -> Metric:
    return _filled(CounterMetricFamily(f"voltcam_{name}", meaning, labels=list(labels)), value)


def _filled(family: GaugeMetricFamily | CounterMetricFamily, value: Any) -> Metric:
    samples: Iterable[Sample] = value if isinstance(value, list) else [((), float(value))]
    for labels, each in samples:
        family.add_metric(list(labels), each)
    return family
