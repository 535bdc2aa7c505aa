"""Recordings of a camera, one at a time: begun, ended, and what is told of them."""

import threading

from .problems import UsageError
from .recorder import Recorder, RecordingPlan, RecordingStatus
from .simulation import Simulation

FINISH_S = 5.0  # for one that is ended: a client may wait for so long
CLOSE_S = 1.5  # for one when the daemon ends


class Recordings:
    """Of a simulation. Its methods may be called from any thread."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._recorder: Recorder | None = None
        self._failed = 0  # of those before
        self._closed = False
        self._control = threading.Lock()  # one change at a time

    @property
    def recorder(self) -> Recorder | None:
        """Of the recording there is, which may have ended by itself."""
        return self._recorder

    def begin(self, plan: RecordingPlan) -> RecordingStatus:
        """Begin one. Raises FormatError, RecordingError, or UsageError when there is one already."""
        with self._control:
            if self._closed:
                raise UsageError("the daemon is ending: start it again")
            former = self._recorder
            if former and former.status.ending:
                raise UsageError(f"{former.status.path} is still being written: wait until status says it is")
            if former and former.status.recording:
                raise UsageError(f"{former.status.path} is being recorded: end that recording first")
            self._recorder = None
            if former:
                former.close(FINISH_S)
                self._failed += former.status.error is not None
            self._recorder = Recorder(plan, self._simulation.setup)
            return self._recorder.status

    def end(self) -> RecordingStatus:
        """Finish it. What takes longer than FINISH_S goes on: its status is `ending` until then.

        Raises UsageError when there is none.
        """
        recorder = self._recorder
        if recorder is None:
            raise UsageError("nothing is being recorded: begin with POST /api/v1/recording")
        recorder.close(FINISH_S)
        with self._control:
            if self._recorder is recorder and not recorder.busy:
                self._recorder = None
                self._failed += recorder.status.error is not None
        return recorder.status

    def close(self) -> None:
        """Finish it, and begin no other. What takes longer than CLOSE_S is left, see `busy`."""
        with self._control:
            self._closed = True
            if self._recorder:
                self._recorder.close(CLOSE_S)

    @property
    def busy(self) -> bool:
        """Whether something is being written."""
        return self._recorder is not None and self._recorder.busy

    @property
    def status(self) -> RecordingStatus | None:
        """Of the recording there is."""
        recorder = self._recorder
        return recorder.status if recorder else None

    @property
    def waiting(self) -> int:
        """How many intervals are still to be written."""
        recorder = self._recorder
        return recorder.waiting if recorder else 0

    @property
    def errors(self) -> int:
        """How many recordings have ended by an error."""
        status = self.status
        return self._failed + bool(status and status.error)
