"""The loop: source -> mailbox -> simulation -> pacer -> transports, each in a thread of its own.

capture     frames from the source; the mailbox keeps the newest
simulation  frame -> interval of events
pacer       interval -> packets, when they are due
transports  one thread each: packets -> bytes -> subscribers
status      once a second, and when the source's state changes
"""

import threading
import time
from collections.abc import Callable, Sequence
from functools import partial

from prometheus_client import Histogram

from voltcam_simulator import Camera, Device, Law
from voltcam_video import Clock, Outcome, SourceRequest

from .beside import DavisSettings
from .camera_settings import PacketSettings, Upsample
from .current_source import CurrentSource
from .interval import Interval
from .mailbox import Arrival, Mailbox
from .messages import status_message
from .overload import OverloadSettings
from .pacer import Pacer
from .publisher import Publisher
from .recorder import Recorder
from .recordings import Recordings
from .simulation import Simulation
from .stages import stage_histogram
from .status import FrameCounts, LatencyStatus, Meter, SourceStatus, State, Status, Waiting
from .transports import Transport

STATUS_PERIOD_S = 1.0
END_S = 1.5  # for threads when the daemon ends
STALLED_S = 5.0  # so long without an interval's end is more than any overload takes


class Emulator:
    """An event camera looking at a source, with transports attached: `start` it, then `stop` it, once.

    clock: what live frames are stamped with; cameras that share one are on one clock.
    on_status is called with each status that is sent. on_failure is called when a thread of it or of a
    transport ends by an error of ours, then in `failure`.
    """

    def __init__(
        self,
        camera: Camera,
        source: SourceRequest,
        *,
        law: Law = "exact",
        device: Device = "cpu",
        seed: int = 0,
        upsample: Upsample = "off",
        packets: PacketSettings | None = None,
        overload: OverloadSettings | None = None,
        davis: DavisSettings | None = None,
        transports: Sequence[Transport] = (),
        clock: Clock | None = None,
        on_status: Callable[[Status], None] = lambda _: None,
        on_failure: Callable[[], None] = lambda: None,
    ) -> None:
        self.camera = camera
        self.simulation = Simulation(camera, law, seed, upsample, overload, davis, device)
        self.recordings = Recordings(self.simulation)
        self.failure: Exception | None = None
        self._transports = transports
        self._on_status, self._on_failure = on_status, on_failure
        self._mailbox = Mailbox(lambda: self.simulation.load.ratio < 1)
        self.stages = stage_histogram()
        frames = (davis or DavisSettings()).frames
        self._publisher = Publisher(camera, transports, lambda: self._mailbox.dropped, self.stages, frames)
        publisher = self._publisher
        self._pacer = Pacer(packets or PacketSettings(), publisher.send_events, publisher.end_interval)
        self._news = threading.Event()  # the status has changed
        self._source = CurrentSource(source, self._mailbox, self._news.set, clock or Clock())
        self._arrived = Meter()
        self._stalls = 0
        self._busy: tuple[float, float] | None = None  # arrival of the frame at hand, and begin of its work
        self._started_s = time.monotonic()
        self._stopping = False
        self._threads = [
            threading.Thread(target=self._guarded, args=(run,), name=f"voltcam-{name}", daemon=True)
            for name, run in (
                ("simulation", self._simulate),
                ("pacer", self._pacer.run),
                ("status", self._report),
            )
        ]

    def start(self) -> None:
        """Open the source, and go. Raises SourceError; `stop` is due in any case."""
        self._source.start()
        for thread in self._threads:
            thread.start()
        self._source.go()

    def stop(self) -> None:
        """End all threads, and finish a recording. What does not end within END_S is left, see `busy`."""
        self._stopping = True
        deadline_s = time.monotonic() + END_S
        self._mailbox.close()
        self._source.stop()
        self._pacer.stop()
        self._news.set()
        for thread in self._threads:
            if thread.ident is not None:
                thread.join(max(0.0, deadline_s - time.monotonic()))
        self.recordings.close()

    @property
    def busy(self) -> bool:
        """After `stop`: whether something goes on that cannot be ended, such as an interval of seconds."""
        return self.recordings.busy or any(thread.is_alive() for thread in self._threads)

    @property
    def histograms(self) -> tuple[Histogram, Histogram]:
        """How long its intervals spend in each stage, and how old events are as they leave."""
        return self.stages, self._publisher.ages

    @property
    def ready(self) -> bool:
        """Whether the first frame has been simulated."""
        return self.simulation.simulated > 0

    @property
    def source(self) -> SourceStatus:
        """What the camera looks at, and how that is going."""
        return self._source.status(self._arrived.status.per_s, self.simulation.fault)

    def look_at(self, request: SourceRequest) -> None:
        """Change the source. While the new one is opened the old one goes on, unless both are one camera.

        Raises SourceError when it cannot be opened: the old one goes on; UsageError while another is opened.
        """
        self._source.look_at(request)

    @property
    def state(self) -> tuple[State, str]:
        """How it is, and why where that is not "running"."""
        source, busy, trouble = self._source.state, self._busy, self.simulation.load.words
        if source.state == "reconnecting":
            return "source lost", source.message
        if source.state == "ended":
            return "ended", source.message or "the source has come to its end"
        if source.state == "waiting":
            return "starting", source.message
        if not self.ready:
            return "starting", "no frame has been simulated yet"
        if busy and (stalled_s := time.monotonic() - busy[1]) > STALLED_S:
            return "stalled", f"one interval has been simulated for {stalled_s:.0f} s: put parameters back"
        if trouble:
            return "overloaded", trouble
        return "running", ""

    @property
    def _latency_now(self) -> LatencyStatus:
        busy = self._busy
        waited_s = time.monotonic() - busy[0] if busy else 0.0
        return self._publisher.latency(waited_s)

    @property
    def status(self) -> Status:
        simulation, mailbox, recordings = self.simulation, self._mailbox, self.recordings
        state, reason = self.state
        return Status(
            state=state,
            reason=reason,
            load=round(simulation.load.ratio, 3),
            skipped_us=simulation.skipped_us,
            source=self.source,
            frames=FrameCounts(
                received=mailbox.received,
                simulated=simulation.simulated,
                dropped=mailbox.dropped,
                skipped=simulation.skipped,
                out_of_order=simulation.out_of_order,
                unusable=simulation.unusable,
            ),
            events=self._publisher.events.status,
            packets=self._publisher.packets.status,
            latency=self._latency_now,
            parameters_version=simulation.parameters[1],
            uptime_s=round(time.monotonic() - self._started_s, 3),
            transports={transport.name: transport.status for transport in self._transports},
            recording=recordings.status,
            waiting=Waiting(
                frames=mailbox.waiting,
                intervals=self._pacer.waiting,
                recording=recordings.waiting,
            ),
            stalls=self._stalls,
            recording_errors=recordings.errors,
        )

    def _simulate(self) -> None:
        while (arrival := self._mailbox.take()) is not None:
            began_s = time.monotonic()
            self._busy = arrival.at_s, began_s
            recorder = self.recordings.recorder
            if recorder:
                recorder.look(self.simulation, self._source.shown)
            self.stages.labels("waiting").observe(began_s - arrival.at_s)
            give = partial(self._give, arrival, recorder, began_s, self.simulation.skipped)
            self.simulation.follow(arrival, give, lambda: self._mailbox.waiting > 0)
            self._busy = None
        self.simulation.finish()

    def _give(
        self, arrival: Arrival, recorder: Recorder | None, began_s: float, skipped: int,
        interval: Interval | None,
    ) -> None:  # fmt: skip
        """On with an interval; skipped: how many had been when its simulation began."""
        self.stages.labels("simulating").observe(time.monotonic() - began_s)
        if interval is not None:
            if recorder:
                recorder.put(interval)
            self._pacer.put(interval)
        if arrival.frame.sent is not None:
            arrival.frame.sent.tell(self._outcome(skipped))

    def _outcome(self, skipped: int) -> Outcome:
        """Of the frame just simulated; skipped: how many had been before it."""
        shift_us = self.simulation.shift_us
        if self.simulation.skipped == skipped:
            return Outcome("simulated", shift_us=shift_us)
        return Outcome("skipped", self.simulation.load.trouble, shift_us)

    def _report(self) -> None:
        former: State = "starting"
        while not self._stopping:
            self._arrived.total = self._mailbox.received
            for meter in (self._arrived, self._publisher.events, self._publisher.packets):
                meter.tick()
            status = self.status
            self._stalls += status.state == "stalled" != former
            former = status.state
            self._on_status(status)
            self._publisher.publish(status_message(status.model_dump()))
            for transport in self._transports:
                if transport.failure is not None:
                    raise transport.failure
            self._news.wait(STATUS_PERIOD_S)
            self._news.clear()

    def _guarded(self, run: Callable[[], None]) -> None:
        try:
            run()
        except Exception as error:
            self.failure = error
            self._on_failure()
