"""A diagnosis beside the running camera: what does it lack to give the events of a reference?

Gathering and diagnosing are processes of their own at a lower priority, so that the stream does not stutter
and what goes wrong there stays there.
"""

import json
import os
import signal
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from voltcam_client.formats import READABLE, FormatError, suffix_of
from voltcam_simulator import Parameters

from ..camera_settings import load_camera
from ..child_process import ChildProcess
from ..emulator import Emulator
from ..problems import UsageError, one_line, where
from .folder import GATHERED, REPORT, START, DiagnosisFolders
from .gather import Figures
from .models import DiagnosisRequest, DiagnosisState

GATHER = [sys.executable, "-m", "voltcam_server.diagnosis.gather"]
DIAGNOSE = [
    sys.executable,
    "-c",
    "import sys; from voltcam_client.cli import main; sys.exit(main())",
    "diagnose",
]
END_S = 0.7  # for a process that is told to end
# Diagnosing takes what nobody else wants, gathering a little more: what it is too late for is lost.
NICE = {"gathering": 10, "running": 19}
SENTENCES, SENTENCE = 1000, 500  # the most that is kept, and characters of each

Changes = dict[str, Any]
"""Of parameters: nested by effect."""
Step = tuple[Literal["gathering", "running"], list[str]]
"""A process, and the state while it runs."""


class DiagnosisRunner:
    """At most one at a time, against the camera of `emulator`, whose ZeroMQ endpoint is `zmq`.

    command: of the diagnosing process, followed by RECORDING --camera FILE --out DIR --seconds S. work: the
    folder for the folders of diagnoses, which are left there; of what was gathered, the last one's.
    """

    def __init__(
        self, emulator: Emulator, zmq: str, *, command: Sequence[str] = DIAGNOSE, work: Path | None = None
    ) -> None:
        self.changes = 0  # counts changes of `state`
        self._emulator, self._zmq = emulator, zmq
        self._command, self._folders = command, DiagnosisFolders(work)
        self._state = DiagnosisState()
        self._lock = threading.RLock()
        self._control = threading.Lock()  # one start or end at a time
        self._thread: threading.Thread | None = None
        self._child: ChildProcess | None = None
        self._ending = False
        self._began = emulator.simulation.parameters[0]  # with the parameters of then
        self._found: Parameters | None = None  # what there is to accept
        self._former: list[Changes] = []  # what there is to revert, the newest last

    @property
    def state(self) -> DiagnosisState:
        return self._state

    @property
    def report(self) -> Path | None:
        """The page for people, once there is one."""
        return Path(self._state.folder, REPORT) if self._state.state == "done" else None

    def start(self, request: DiagnosisRequest) -> DiagnosisState:
        """Begin, from the parameters in force.

        Raises UsageError where a diagnosis is running, FormatError for a reference that cannot be one.
        """
        with self._control:
            if self._running:
                raise UsageError("a diagnosis is running: wait, or end it with DELETE /api/v1/diagnosis")
            if request.reference is not None:
                _check_recording(Path(request.reference))
            if self._thread:
                self._thread.join()
            self._folders.tidy_up()
            self._began = self._emulator.simulation.parameters[0]
            camera = self._emulator.camera.model_copy(update={"parameters": self._began})
            folder = self._folders.make(camera)
            steps = self._steps(request, folder)
            self._ending, self._found = False, None
            with self._lock:
                self._state = DiagnosisState(
                    state=steps[0][0],
                    reference=request.reference or request.stream or "",
                    folder=str(folder),
                    revertible=bool(self._former),
                )
                self.changes += 1
            self._thread = threading.Thread(target=self._run, args=(steps, folder), name="voltcam-diagnosis")
            self._thread.start()
            return self._state

    def end(self) -> DiagnosisState:
        """End the diagnosis before it is done. Raises UsageError when none is running."""
        with self._control:
            if not self._running:
                raise UsageError("no diagnosis is running: begin with POST /api/v1/diagnosis")
            self._end_child()
            return self._state

    def stop(self) -> None:
        """The daemon ends."""
        with self._control:
            self._end_child()
            self._folders.tidy_up()

    def accept(self) -> int:
        """Run with what was found, from the next frame on; returns the new parameters_version. What it left
        as it was stays as it is now.

        Raises UsageError where there is nothing to accept.
        """
        found, simulation = self._found, self._emulator.simulation
        if found is not None:
            simulation.prepare(found)
        with self._lock:
            if found is None or found is not self._found or not self._state.acceptable:
                raise UsageError("there is nothing to accept: only what a diagnosis has found, and once")
            former = simulation.parameters[0]
            accepted, version = simulation.change(found.changes_since(self._began))
            self._former.append(former.changes_since(accepted))
            self._set(acceptable=False, revertible=True)
            return version

    def revert(self) -> int:
        """Run without what the last `accept` changed, from the next frame on; the same of it."""
        with self._lock:
            if not self._former:
                raise UsageError("there is nothing to revert: nothing that a diagnosis found was accepted")
            version = self._emulator.simulation.change(self._former.pop())[1]
            self._set(acceptable=self._found is not None, revertible=bool(self._former))
            return version

    @property
    def _running(self) -> bool:
        return self._state.state in ("gathering", "running")

    def _steps(self, request: DiagnosisRequest, folder: Path) -> list[Step]:
        seconds, gathered = f"{request.seconds:g}", folder / GATHERED
        recording = gathered if request.stream else Path(request.reference or "").absolute()
        diagnose = [*self._command, str(recording), "--camera", str(folder / START), "--out", str(folder)]
        diagnose += ["--seconds", seconds]
        if request.stream is None:
            return [("running", diagnose)]
        gather = [*GATHER, self._zmq, request.stream, str(gathered), seconds]
        return [("gathering", gather), ("running", diagnose)]

    def _run(self, steps: list[Step], folder: Path) -> None:
        try:
            for state, command in steps:
                self._set(state=state)
                self._run_child(command, NICE[state], folder / f"{state}.log")
            result = json.loads((folder / "result.json").read_text())
            if result["effects"] or result["residual"]:
                self._found = load_camera(str(folder / "camera.yaml")).parameters
            self._set(state="done", result=result, acceptable=self._found is not None)
        except Exception as error:
            if self._ending:
                self._set(state="idle")
            else:
                ours = not isinstance(error, UsageError | OSError)
                self._set(state="failed", error=where(error) if ours else one_line(error))

    def _run_child(self, command: list[str], nice: int, log: Path) -> None:
        with self._lock:
            if self._ending:
                raise UsageError("ended")
            self._child = ChildProcess(command, nice, log)
        self._child.follow(self._hear)

    def _hear(self, line: str) -> None:
        if self._state.state == "gathering" and line.startswith("{"):
            self._set(figures=Figures.model_validate_json(line))
        elif line:
            self._set(progress=[*self._state.progress, line[:SENTENCE]][-SENTENCES:])

    def _end_child(self) -> None:
        for number in (signal.SIGTERM, signal.SIGKILL):
            with self._lock:
                self._ending = True
                if self._child:
                    self._child.signal(number)
            if self._thread:
                self._thread.join(END_S)

    def _set(self, **changes: Any) -> None:
        with self._lock:
            self._state = self._state.model_copy(update=changes)
            self.changes += 1


def _check_recording(path: Path) -> None:
    """Whether it may be one; the rest is seen when it is read."""
    if not os.path.exists(path):  # noqa: PTH110 Path's own raises for a name that is too long
        raise FormatError(f"{path} is not there: give the path of a recording on the daemon's host")
    if not path.is_dir() and suffix_of(path) not in READABLE:
        raise FormatError(f"{path}: no recording has the suffix {path.suffix!r}: give {', '.join(READABLE)}")
