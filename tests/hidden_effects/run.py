"""Case after case to the diagnosis, each in a process of its own, and its verdict to disk."""

import os
import signal
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path

from pydantic import BaseModel, ConfigDict
from tests.generator import Recorded
from tests.results import digest, whole_lines

from .ask import Question, Verdict, ask
from .cases import Case, recorded

Work = Callable[[Case], "Line"]


class Line(BaseModel):
    """Of the results file: a case and the verdict on it, or what went wrong."""

    model_config = ConfigDict(frozen=True)

    case: str
    code: str = ""  # digest of the sources that gave the verdict
    verdict: Verdict | None = None
    error: str = ""
    cpu_s: float = 0.0  # of the diagnosis
    wall_s: float = 0.0


def diagnosed(case: Case, diagnosis: Callable[[Question], Verdict] = ask) -> Line:
    """The verdict on a case, by whoever gets to see the recording and nothing else."""
    asked = question(case, recorded(case))
    begun, cpu = time.perf_counter(), time.process_time()
    verdict = diagnosis(asked)
    return Line(
        case=case.name, code=digest(__name__), verdict=verdict, cpu_s=time.process_time() - cpu,
        wall_s=time.perf_counter() - begun,
    )  # fmt: skip


def question(case: Case, recording: Recorded) -> Question:
    """What of a recording may be seen, and how the catalogue is tampered with."""
    effect = case.effects[0][0] if case.effects else None
    return Question(
        recording.events, recording.frames, recording.frame_t_us, recording.width, recording.height,
        recording.truth["base"]["camera"],
        without=effect if case.sabotage == "deleted" else None,
    )  # fmt: skip


def run(cases: Iterable[Case], file: Path, jobs: int, work: Work = diagnosed) -> Generator[Line, None, None]:
    """Diagnose the cases without a line in `file`, `jobs` at a time; yields lines when they are written."""
    done = {line.case for line in read(file)}
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a", encoding="utf-8") as results:
        for line in _answers([case for case in cases if case.name not in done], jobs, work):
            results.write(line.model_dump_json() + "\n")
            results.flush()
            os.fsync(results.fileno())
            yield line


def read(file: Path) -> list[Line]:
    """The lines of a results file."""
    return [Line.model_validate_json(line) for line in whole_lines(file)]


def _answers(cases: list[Case], jobs: int, work: Work) -> Iterator[Line]:
    """In the order they come. A process that dies gives a line too."""
    waiting = iter(cases)
    running: dict[Connection, tuple[Case, SpawnProcess]] = {}
    try:
        while True:
            while len(running) < jobs and (case := next(waiting, None)):
                receiver, process = _begun(case, work)
                running[receiver] = case, process
            if not running:
                return
            ready = wait(list(running))
            for receiver in [one for one in running if one in ready]:
                case, process = running.pop(receiver)
                yield _answer(case, receiver, process)
    finally:
        for _, process in running.values():
            process.terminate()


def _begun(case: Case, work: Work) -> tuple[Connection, SpawnProcess]:
    context = get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_in_process, args=(case, work, sender), daemon=True)
    interrupt = signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is ours; processes inherit that
    process.start()
    signal.signal(signal.SIGINT, interrupt)
    sender.close()
    return receiver, process


def _in_process(case: Case, work: Work, sender: Connection) -> None:
    try:
        line = work(case)
    except Exception as error:  # counts as wrong
        line = Line(case=case.name, code=digest(__name__), error=f"{type(error).__name__}: {error}")
    sender.send(line.model_dump_json())


def _answer(case: Case, receiver: Connection, process: SpawnProcess) -> Line:
    try:
        line = Line.model_validate_json(receiver.recv())
    except EOFError:
        process.join()
        ended = f"its process ended with {process.exitcode}"
        line = Line(case=case.name, code=digest(__name__), error=ended)
    process.join()
    receiver.close()
    return line
