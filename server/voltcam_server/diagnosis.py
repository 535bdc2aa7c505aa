"""A diagnosis beside the running camera: what does it lack to give the events of a reference?

Gathering and diagnosing are processes of their own at a lower priority, so that the stream does not stutter
and what goes wrong there stays there.
"""

import contextlib
import json
import os
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic.config import JsonDict, JsonValue

from voltcam_client.formats import READABLE, FormatError
from voltcam_simulator import Parameters

from .camera_settings import load_camera
from .child import Child
from .emulator import Emulator
from .gather import Figures
from .problems import UsageError, one_line, where

GATHER = [sys.executable, "-m", "voltcam_server.gather"]
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
FOLDER, REPORT = "voltcam-diagnosis-", "report.html"
START, GATHERED = "start.yaml", "gathered.npz"  # the camera that a diagnosis begins from; of a stream

Changes = dict[str, Any]
"""Of parameters: nested by effect."""
Step = tuple[Literal["gathering", "running"], list[str]]
"""A process, and the state while it runs."""


def _only(name: str) -> JsonDict:
    """In JSON schema: this one of the two, and not the other."""
    other = {"reference": "stream", "stream": "reference"}[name]
    return {"required": [name], "properties": {name: {"type": "string"}, other: {"type": "null"}}}


ONE_OF_THEM: list[JsonValue] = [_only("reference"), _only("stream")]


class DiagnosisRequest(BaseModel):
    """What to hold the camera against: a recording, or a second camera."""

    model_config = ConfigDict(
        use_attribute_docstrings=True,
        extra="forbid",
        json_schema_extra={"oneOf": [_only("reference"), _only("stream")]},
    )

    reference: str | None = Field(default=None, min_length=1, max_length=4096)
    """a recording on the daemon's host; this or stream"""

    stream: str | None = Field(
        default=None, pattern=r"^(tcp|ipc)://\S+$", max_length=4096, examples=["tcp://127.0.0.1:5561"]
    )
    """ZeroMQ address of a camera that looks at the same scene; this or reference"""

    seconds: float = Field(default=10, gt=0, le=60)
    """of it to look at, s"""

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.reference is None) == (self.stream is None):
            raise ValueError("give either reference, a recording's path, or stream, a camera's address")
        return self


class DiagnosisState(BaseModel):
    """One diagnosis: what of, how far it is, what it found."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    state: Literal["idle", "gathering", "running", "done", "failed"] = "idle"
    """how far it is"""

    reference: str = ""
    """what the camera is held against"""

    progress: list[str] = []
    """sentences, the newest last"""

    figures: Figures | None = None
    """while gathering"""

    error: str = ""
    """in one line, when failed"""

    result: dict[str, Any] | None = None
    """result.json, when done"""

    folder: str = ""
    """where its files are, on the daemon's host"""

    acceptable: bool = False
    """whether there is something to accept"""

    revertible: bool = False
    """whether there is something to revert"""


class Diagnosis:
    """At most one at a time, against the camera of `emulator`, whose ZeroMQ endpoint is `zmq`.

    command: of the diagnosing process, followed by RECORDING --camera FILE --out DIR --seconds S. work: the
    folder for the folders of diagnoses, which are left there; of what was gathered, the last one's.
    """

    def __init__(
        self, emulator: Emulator, zmq: str, *, command: Sequence[str] = DIAGNOSE, work: Path | None = None
    ) -> None:
        self.changes = 0  # counts changes of `state`
        self._emulator, self._zmq = emulator, zmq
        self._command, self._work = command, work
        self._state = DiagnosisState()
        self._lock = threading.RLock()
        self._control = threading.Lock()  # one start or end at a time
        self._thread: threading.Thread | None = None
        self._child: Child | None = None
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
            self._tidy_up()
            self._began = self._emulator.simulation.parameters[0]
            folder = self._make_folder()
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
            self._tidy_up()

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

    def _tidy_up(self) -> None:
        """Of folders of diagnoses that are over: all of those without a report, the large things of others.

        Also those of daemons that are gone, which may have been killed.
        """
        root = self._work or Path(tempfile.gettempdir())
        for folder in root.glob(f"{FOLDER}*"):
            pid = folder.name.removeprefix(FOLDER).partition("-")[0]
            if folder.name.startswith(self._prefix) or not Path("/proc", pid).exists():
                _thin_out(folder)

    @property
    def _prefix(self) -> str:
        """Of our folders: no other camera's, and no other daemon's."""
        return f"{FOLDER}{os.getpid()}-{id(self):x}-"

    def _make_folder(self) -> Path:
        """A new one, with the camera as it is in it."""
        camera = self._emulator.camera.model_copy(update={"parameters": self._began})
        try:
            folder = Path(tempfile.mkdtemp(prefix=self._prefix, dir=self._work))
            (folder / START).write_text(camera.to_yaml())
        except OSError as error:
            raise UsageError(f"no folder for the diagnosis: {one_line(error)}: set TMPDIR") from None
        return folder

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
            self._child = Child(command, nice, log)
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


def _thin_out(folder: Path) -> None:
    if not (folder / REPORT).exists():
        shutil.rmtree(folder, ignore_errors=True)
        return
    with contextlib.suppress(OSError):  # it is not ours alone
        for path in folder.iterdir():
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            elif path.name == GATHERED:
                path.unlink()


def _check_recording(path: Path) -> None:
    """Whether it may be one; the rest is seen when it is read."""
    if not os.path.exists(path):  # noqa: PTH110 Path's own raises for a name that is too long
        raise FormatError(f"{path} is not there: give the path of a recording on the daemon's host")
    if not path.is_dir() and path.suffix.lower() not in READABLE:
        raise FormatError(f"{path}: no recording has the suffix {path.suffix!r}: give {', '.join(READABLE)}")
