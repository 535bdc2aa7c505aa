"""A running camera as the topics of a DAVIS' driver: /dvs/events, image_raw, camera_info, imu."""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from voltcam_client.camera import EventCamera, Stream
from voltcam_client.formats.ros_messages import EventsAs
from voltcam_client.intrinsics import UNKNOWN_INTRINSICS, Intrinsics
from voltcam_client.packet import FrameMessage, Packet
from voltcam_client.ros1 import RosError, messages
from voltcam_client.ros1.node import Node
from voltcam_client.ros1.publication import Publication
from voltcam_client.samples import SamplesMessage

POLL_S = 0.1
QUIET_S, TOLD_S = 2.0, 10.0
Message = TypeVar("Message", Packet, FrameMessage, SamplesMessage)
log = logging.getLogger("voltcam")


@dataclass(frozen=True, slots=True, kw_only=True)
class BridgeSettings:
    """namespace: of the topics. events: the type of messages. frame_id: None is the camera's name.

    queue_size: messages that wait for each subscriber. clock: publish /clock, for a stream of simulated time.
    """

    namespace: str = "dvs"
    events: EventsAs = "packet"
    intrinsics: Intrinsics = UNKNOWN_INTRINSICS
    frame_id: str | None = None
    queue_size: int = 100
    clock: bool = False


class Bridge:
    """Forwards all that `camera` gives, until told to end. Raises RosError where topics have no names."""

    def __init__(self, node: Node, camera: EventCamera, settings: BridgeSettings) -> None:
        self._node, self._camera, self._settings = node, camera, settings
        kind = "event_camera_msgs/EventPacket" if settings.events == "packet" else "dvs_msgs/EventArray"
        self._events = self._topic("events", kind)
        self._images = self._topic("image_raw", "sensor_msgs/Image")
        self._infos = self._topic("camera_info", "sensor_msgs/CameraInfo")
        self._imu = self._topic("imu", "sensor_msgs/Imu")
        self._topics = [self._events, self._images, self._infos, self._imu]
        if settings.clock:
            self._clock = node.advertise("/clock", "rosgraph_msgs/Clock", settings.queue_size)
            self._topics.append(self._clock)
        self._clock_us = -1
        self._heard_s, self._quiet = time.monotonic(), False
        self._told_s, self._told = time.monotonic(), 0
        self._failure: Exception | None = None
        self._over = threading.Event()

    def run(self, stopped: Callable[[], bool]) -> None:
        """Until then. Raises RosError where the roscore ends, and PacketError for what no daemon sends."""
        with self._camera.frames() as frames, self._camera.imu() as imu:
            threads = [
                self._forward(self._camera, self._on_events),
                self._forward(frames, self._on_frame),
                self._forward(imu, self._on_imu),
            ]
            try:
                while not stopped() and self._failure is None:
                    self._node.check()
                    self._tell()
                    self._over.wait(POLL_S)
            finally:
                self._over.set()
                for thread in threads:
                    thread.join()
        if self._failure is not None:
            raise self._failure

    def _topic(self, name: str, kind: str) -> Publication:
        return self._node.advertise(f"{self._settings.namespace}/{name}", kind, self._settings.queue_size)

    def _forward(self, stream: Stream[Message], publish: Callable[[Message], None]) -> threading.Thread:
        """Messages of a stream, in a thread."""

        def run() -> None:
            try:
                while not self._over.is_set():
                    message = stream.receive(POLL_S)
                    if message is not None:
                        publish(message)
            except Exception as error:  # what the main thread is to raise
                self._failure = error
                self._over.set()

        thread = threading.Thread(target=run, name="voltcam-ros1-bridge", daemon=True)
        thread.start()
        return thread

    def _on_events(self, packet: Packet) -> None:
        self._heard_s = time.monotonic()
        if self._events.wanted:
            as_message = messages.event_packet if self._settings.events == "packet" else messages.event_array
            frame_id = self._settings.frame_id or packet.frame_id
            self._events.publish(as_message(packet, self._events.next_sequence, frame_id))
        if self._settings.clock:
            self._on_time(int(packet.events["t"][-1]) if packet.events.size else packet.time_base_ns // 1000)

    def _on_time(self, t_us: int) -> None:
        """It goes back where the daemon was started again, and is said in any case."""
        if t_us != self._clock_us:
            self._clock_us = t_us
            self._clock.publish(messages.clock(t_us))

    def _on_frame(self, frame: FrameMessage) -> None:
        intrinsics, frame_id = self._settings.intrinsics, self._settings.frame_id or frame.frame_id
        size = frame.image.shape[1], frame.image.shape[0]
        if intrinsics.size not in (None, size):
            (w, h), (width, height) = intrinsics.size, size
            raise RosError(
                f"the calibration is of {w} x {h} pixels, and the camera has {width} x {height}: calibrate it"
            )
        if self._images.wanted:
            self._images.publish(messages.image(frame, self._images.next_sequence, frame_id))
        if self._infos.wanted:
            sequence = self._infos.next_sequence
            self._infos.publish(messages.camera_info(frame, intrinsics, sequence, frame_id))

    def _on_imu(self, samples: SamplesMessage) -> None:
        if self._imu.wanted:
            frame_id = self._settings.frame_id or samples.frame_id
            for sample in samples.samples:
                self._imu.publish(messages.imu(sample, self._imu.next_sequence, frame_id))

    def _tell(self) -> None:
        """On standard error: that nothing comes, and that something was left out."""
        now_s = time.monotonic()
        quiet = now_s - self._heard_s > QUIET_S
        if quiet and not self._quiet:
            url = self._camera.url
            log.warning("nothing from %s for %g s, waiting: is `voltcam serve` running there?", url, QUIET_S)
        self._quiet = quiet
        if now_s - self._told_s < TOLD_S:
            return
        lost = self._camera.lost_packets + sum(topic.dropped for topic in self._topics)
        if lost > self._told:
            words = "%d messages were left out: this machine, or a subscriber, is slower than the camera"
            log.warning(words, lost - self._told)
        self._told_s, self._told = now_s, lost
