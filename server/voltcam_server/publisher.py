"""What leaves a camera: packets of events and frames to all its transports, counted and timed."""

import time
from collections.abc import Callable, Sequence

from prometheus_client import Histogram

from voltcam_client.packet import FrameMessage, Packet
from voltcam_simulator import Camera

from .interval import Interval
from .messages import Message, events_message, frame_message
from .pacer import Slice
from .status import LatencyStatus, Meter
from .transports import Transport


class Publisher:
    """Of one camera. dropped: how many source frames have been, now; stages: see `stages`."""

    def __init__(
        self, camera: Camera, transports: Sequence[Transport], dropped: Callable[[], int], stages: Histogram
    ) -> None:
        self._camera, self._transports, self._dropped, self._stages = camera, transports, dropped, stages
        self.events, self.packets = Meter(), Meter()
        self._frame_seq = 0
        self._latency = LatencyStatus(simulated_ms=0, sent_ms=0, age_ms=0)
        self._age_s = 0.0  # of the events that left last

    def latency(self, waited_s: float) -> LatencyStatus:
        """Now, while the frame that is being simulated came so long ago."""
        return self._latency.model_copy(update={"age_ms": round(1000 * max(self._age_s, waited_s), 3)})

    def send_events(self, interval: Interval, piece: Slice) -> None:
        """A packet of an interval's events."""
        packet = Packet(
            events=piece.events,
            width=self._camera.width,
            height=self._camera.height,
            seq=self.packets.total,
            time_base_ns=1000 * piece.start_us,
            stamp_ns=time.time_ns(),
            frame_id=self._camera.name,
            parameters_version=interval.parameters_version,
            dropped=self._dropped(),
        )
        self.publish(events_message(packet))
        self._age_s = time.monotonic() - interval.arrived_s + (interval.frame_us - piece.end_us) / 1e6
        self.packets.total += 1
        self.events.total += piece.events.size

    def end_interval(self, interval: Interval) -> None:
        """All its events have left: now its frame, so that both arrive in the order of their times."""
        frame = FrameMessage(
            image=interval.image_u8,
            seq=self._frame_seq,
            t_us=interval.frame_us,
            stamp_ns=time.time_ns(),
            frame_id=self._camera.name,
            parameters_version=interval.parameters_version,
        )
        self.publish(frame_message(frame))
        self._stages.labels("leaving").observe(time.monotonic() - interval.ready_s)
        self._frame_seq += 1
        self._latency = LatencyStatus(
            simulated_ms=round(1000 * (interval.ready_s - interval.arrived_s), 3),
            sent_ms=round(1000 * (time.monotonic() - interval.arrived_s), 3),
            age_ms=0,
        )

    def publish(self, message: Message) -> None:
        """A message to all transports."""
        for transport in self._transports:
            transport.publish(message)
