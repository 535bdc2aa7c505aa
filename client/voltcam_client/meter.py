"""The rates of a running camera: what `voltcam listen` prints."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from voltcam_client.camera import EventCamera


@dataclass(frozen=True)
class Rates:
    """A camera over some time. What there were no packets or events to take from is None.

    lost_packets, restarts  since the camera was opened, see EventCamera
    dropped                 source frames that the daemon has skipped since it started
    """

    seconds: float
    events_per_s: float
    packets_per_s: float
    on_share: float | None
    latency_median_ms: float | None
    latency_p99_ms: float | None
    lost_packets: int
    restarts: int
    dropped: int | None
    parameters_version: int | None

    def __str__(self) -> str:
        if self.latency_median_ms is None:
            return f"no packets, {self.lost_packets} lost"
        on = "-" if self.on_share is None else f"{self.on_share:.1%}"
        return (
            f"{short(self.events_per_s):>5} events/s  {on:>6} ON  {self.packets_per_s:5.0f} packets/s  "
            f"{self.lost_packets} lost  latency {self.latency_median_ms:.2f} ms, "
            f"99 % below {self.latency_p99_ms:.2f} ms"
        )


def measure(camera: EventCamera, seconds: float, stop: Callable[[], bool] = lambda: False) -> Rates:
    """Receive for so many seconds, or until `stop` says so, and sum up."""
    begin = time.monotonic()
    last, event_count, on_count = None, 0, 0
    latencies_us: list[int] = []
    while (left_s := begin + seconds - time.monotonic()) > 0 and not stop():
        packet = camera.receive(left_s)
        if packet is None:
            continue
        last = packet
        latencies_us.append(camera.latency_us or 0)
        event_count += packet.events.size
        on_count += int(np.count_nonzero(packet.events["p"]))
    elapsed_s = time.monotonic() - begin
    return Rates(
        seconds=elapsed_s,
        events_per_s=event_count / elapsed_s,
        packets_per_s=len(latencies_us) / elapsed_s,
        on_share=on_count / event_count if event_count else None,
        latency_median_ms=_percentile_ms(latencies_us, 50),
        latency_p99_ms=_percentile_ms(latencies_us, 99),
        lost_packets=camera.lost_packets,
        restarts=camera.restarts,
        dropped=last.dropped if last else None,
        parameters_version=last.parameters_version if last else None,
    )


def _percentile_ms(latencies_us: list[int], percentage: float) -> float | None:
    return float(np.percentile(latencies_us, percentage)) / 1000 if latencies_us else None


def short(number: float) -> str:
    """Three digits and a unit: 1234567 is '1.23M'."""
    for size, unit in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if number >= 0.9995 * size:
            return f"{number / size:.3g}{unit}"
    return f"{number:.3g}"
