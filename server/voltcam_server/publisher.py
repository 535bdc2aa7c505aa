"""What leaves a camera: packets of events and frames to all its transports, counted and timed."""

import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from prometheus_client import Histogram

from voltcam_client.packet import TOPIC_FRAMES, FrameMessage, Packet
from voltcam_client.samples import TOPIC_IMU, TOPIC_TRIGGERS, SamplesMessage
from voltcam_simulator import ApsFrame, Camera

from .beside import Beside, Frames
from .interval import Interval
from .messages import Message, events_message, frame_message, samples_message
from .pacer import Slice
from .stages import age_histogram
from .status import LatencyStatus, Meter
from .transports import Transport


class Publisher:
    """Of one camera. dropped: how many source frames have been, now; stages: see `stages`."""

    def __init__(
        self,
        camera: Camera,
        transports: Sequence[Transport],
        dropped: Callable[[], int],
        stages: Histogram,
        frames: Frames = "source",
    ) -> None:
        self._camera, self._transports, self._dropped, self._stages = camera, transports, dropped, stages
        self.events, self.packets = Meter(), Meter()
        self._frames = frames
        self._seqs = {TOPIC_FRAMES: 0, TOPIC_IMU: 0, TOPIC_TRIGGERS: 0}
        self._beside: tuple[Interval | None, Beside] = None, Beside()  # what has not left of an interval
        self._latency = LatencyStatus(simulated_ms=0, sent_ms=0, age_ms=0)
        self._age_s = 0.0  # of the events that left last
        self.ages = age_histogram()

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
        self.ages.observe(self._age_s)
        self.packets.total += 1
        self.events.total += piece.events.size
        self._send_beside(interval, piece.end_us)

    def end_interval(self, interval: Interval) -> None:
        """All its events have left: now its frame, so that both arrive in the order of their times."""
        self._send_beside(interval, None)
        if self._frames == "source":
            self._send_frame(interval, interval.image_u8, interval.frame_us)
        self._stages.labels("leaving").observe(time.monotonic() - interval.ready_s)
        self._latency = LatencyStatus(
            simulated_ms=round(1000 * (interval.ready_s - interval.arrived_s), 3),
            sent_ms=round(1000 * (time.monotonic() - interval.arrived_s), 3),
            age_ms=0,
        )

    def _send_beside(self, interval: Interval, t_us: int | None) -> None:
        """What has not left of it, up to before t_us; None: all."""
        of, left = self._beside
        if of is not interval:
            left = interval.beside
        now, left = (left, Beside()) if t_us is None else left.cut(t_us)
        self._beside = interval, left
        for frame in now.frames:
            self._send_frame(interval, frame.image, sum(frame.exposure_us) // 2, frame)
        for topic, samples in ((TOPIC_IMU, now.imu), (TOPIC_TRIGGERS, now.triggers)):
            if samples.size:
                message = SamplesMessage(
                    samples=samples,
                    seq=self._next(topic),
                    stamp_ns=time.time_ns(),
                    frame_id=self._camera.name,
                )
                self.publish(samples_message(topic, message))

    def _send_frame(
        self, interval: Interval, image: NDArray[np.uint8], t_us: int, aps: ApsFrame | None = None
    ) -> None:
        frame = FrameMessage(
            image=image,
            seq=self._next(TOPIC_FRAMES),
            t_us=t_us,
            stamp_ns=time.time_ns(),
            frame_id=self._camera.name,
            parameters_version=interval.parameters_version,
            exposure_us=aps and aps.exposure_us,
            frame_us=aps and aps.frame_us,
            gamma=interval.gamma if aps is None else 1.0,
        )
        self.publish(frame_message(frame))

    def _next(self, topic: bytes) -> int:
        seq = self._seqs[topic]
        self._seqs[topic] += 1
        return seq

    def publish(self, message: Message) -> None:
        """A message to all transports."""
        for transport in self._transports:
            transport.publish(message)
