"""Pair after pair, each in a process of its own, and what came of it to disk."""

import multiprocessing
import os
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from pathlib import Path

from tests.results import digest, whole_lines

from .judge import Outcome, judged
from .pairs import Pair

Work = Callable[[Pair], Outcome]


def run(pairs: Iterable[Pair], file: Path, jobs: int, work: Work | None = None) -> Generator[Outcome]:
    """Judge the pairs that are not in `file`, `jobs` at a time; yields outcomes when they are written."""
    done = {outcome.seed for outcome in read(file)}
    work = work or partial(judged, code=digest(__name__))
    file.parent.mkdir(parents=True, exist_ok=True)
    spawn = multiprocessing.get_context("spawn")
    # A worker ends after each pair, so that none works in what another has left.
    pool = ProcessPoolExecutor(jobs, mp_context=spawn, max_tasks_per_child=1)
    try:
        waiting = {pool.submit(work, pair): pair for pair in pairs if pair.seed not in done}
        with file.open("a", encoding="utf-8") as results:
            for future in as_completed(waiting):
                error = future.exception()
                failed = Outcome(seed=waiting[future].seed, error=f"{type(error).__name__}: {error}")
                outcome = failed if error else future.result()
                results.write(outcome.model_dump_json() + "\n")
                results.flush()
                os.fsync(results.fileno())
                yield outcome
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def read(file: Path) -> list[Outcome]:
    """The outcomes in a file."""
    return [Outcome.model_validate_json(line) for line in whole_lines(file)]
