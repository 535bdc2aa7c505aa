"""The status in Prometheus' text format (version 0.0.4)."""

from collections.abc import Iterator, Sequence

from .status import Status

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
Sample = tuple[dict[str, str], float]


def prometheus(status: Status) -> str:
    """Counters end in _total; all names start with voltcam_."""
    return "".join(f"{line}\n" for line in _lines(status))


def _lines(status: Status) -> Iterator[str]:
    frames, latency, recording = status.frames, status.latency, status.recording
    transports = [({"transport": name}, each) for name, each in status.transports.items()]
    fates = [({"fate": fate}, count) for fate, count in frames.model_dump(exclude={"received"}).items()]
    sent = [(label, each.packets_sent) for label, each in transports]
    dropped = [(label, each.packets_dropped) for label, each in transports]
    until = [
        ({"until": "simulated"}, latency.simulated_ms / 1000),
        ({"until": "sent"}, latency.sent_ms / 1000),
    ]
    yield from _samples(
        "state", "gauge", "1 for the state the daemon is in", [({"state": status.state}, 1.0)]
    )
    yield from _metric("load", "gauge", "time of simulating beside the time it is for", status.load)
    yield from _metric("skipped_seconds_total", "counter", "stream time left out", status.skipped_us / 1e6)
    yield from _metric("age_seconds", "gauge", "age of what is being sent", latency.age_ms / 1000)
    yield from _metric(
        "source_up", "gauge", "1 while the source gives frames", status.source.state == "running"
    )
    yield from _metric("source_fps", "gauge", "frames from the source per second", status.source.fps)
    yield from _metric("frames_received_total", "counter", "frames from the source", frames.received)
    yield from _samples("frames_total", "counter", "frames from the source, by what became of them", fates)
    yield from _metric("events_total", "counter", "events sent off", status.events.total)
    yield from _metric("packets_total", "counter", "event packets sent off", status.packets.total)
    yield from _samples("packets_sent_total", "counter", "event packets sent to subscribers", sent)
    yield from _samples("packets_dropped_total", "counter", "event packets dropped for slow ones", dropped)
    yield from _samples("latency_seconds", "gauge", "newest interval, from its last frame's arrival", until)
    yield from _metric("parameters_version", "gauge", "changes of parameters", status.parameters_version)
    yield from _metric(
        "recording", "gauge", "1 while recording", recording is not None and recording.recording
    )
    yield from _metric("uptime_seconds", "gauge", "since the daemon started", status.uptime_s)


def _metric(name: str, kind: str, meaning: str, value: float) -> Iterator[str]:
    return _samples(name, kind, meaning, [({}, value)])


def _samples(name: str, kind: str, meaning: str, samples: Sequence[Sample]) -> Iterator[str]:
    yield f"# HELP voltcam_{name} {meaning}"
    yield f"# TYPE voltcam_{name} {kind}"
    for labels, value in samples:
        inside = ",".join(f'{key}="{text}"' for key, text in labels.items())
        yield f"voltcam_{name}{{{inside}}} {value:.15g}" if inside else f"voltcam_{name} {value:.15g}"
