"""All items of a data set: looked at, made on an engine, and written down in the manifest."""

import shutil
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from tqdm import tqdm

from voltcam_client.meter import short

from ..problems import UsageError, one_line
from ..signals import ended_by_signal
from .clips import Item, clips_of, items_of
from .engines import Engine, EngineGoneError
from .item import ASIDE, ItemOutcome, Making, failure, make_item
from .manifest import SetManifest, locked
from .probe import Probed, probed
from .space import space_for
from .spec import Spec

SPEC = "spec.json"
STOPPED = "it was stopped"


@dataclass
class Made:
    """What became of a set. made, before: items of this run, and those that were there. failed: with reasons.
    left: not tried, since it was stopped or the disk is full."""

    out: Path
    made: int = 0
    before: int = 0
    left: int = 0
    events: int = 0
    failed: int = 0
    ended: str = ""

    @property
    def words(self) -> str:
        """In a line."""
        parts = [
            f"{self.out}: {self.made} items made, {short(self.events)} events",
            f"{self.before} were there" if self.before else "",
            f"{self.failed} could not be made, see the lines above and manifest.jsonl" if self.failed else "",
            f"{self.ended}; {self.left} are left: the same command goes on" if self.left else "",
        ]
        return "; ".join(filter(None, parts))


def make_set(spec: Spec, out: Path, engine: Callable[[], Engine]) -> Made:
    """Make what is not there yet. SIGINT and SIGTERM end it when the items under way are done; a second one,
    at once. engine: opened when the inputs were looked at. Raises UsageError before anything is made, for
    what could not end well."""
    clips = clips_of(spec)
    items = items_of(spec, clips)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{out} cannot be made: {error.strerror}: give another folder") from None
    with locked(out):
        manifest = SetManifest(out)
        wanted = _not_there(items, manifest, out)
        looked = {one.clip.name: one for one in _looked_at(wanted, spec)}
        good = [item for item in wanted if not looked[item.clip.name].problem]
        result = Made(out, before=len(items) - len(wanted))
        if wanted and not good:
            raise UsageError("no input can be used, see the lines above")
        making = Making(
            out.absolute(),
            spec.cameras(),
            spec.law,
            spec.device,
            "cubic" if spec.upsample == "off" else spec.upsample,
            spec.fit,
            spec.seconds,
            spec.frames,
        )
        frames = [looked[item.clip.name].frames for item in good]
        with engine() as running:
            if good:
                running.check(making.out)
                space_for(good, frames, making).check(out, running.workers)
            _begin(out, spec)
            bad = [failure(one, looked[one.clip.name].problem) for one in wanted if one not in set(good)]
            _run(running, making, good, frames, bad, manifest, result)
        shutil.rmtree(out / ASIDE, ignore_errors=True)
    return result


def _run(
    engine: Engine,
    making: Making,
    items: Sequence[Item],
    frames: Sequence[int],
    bad: Sequence[ItemOutcome],
    manifest: SetManifest,
    result: Made,
) -> None:
    stop = threading.Event()
    frames_of = dict(zip(items, frames, strict=True))
    result.left, result.failed = len(items), len(bad)
    try:
        for outcome in bad:
            manifest.add(outcome)
        with _bar(sum(frames)) as bar, _ended_by_signals(engine, stop, bar):
            for outcome in engine.run(partial(make_item, making=making), items, stop):
                bar.update(frames_of[outcome.item])
                if outcome.full:
                    result.ended = f"the disk is full: {outcome.failed}"
                    stop.set()
                    continue
                manifest.add(outcome)
                result.left -= 1
                _count(outcome, result, bar)
        if stop.is_set() and not result.ended:
            result.ended = STOPPED
    except EngineGoneError as error:
        result.ended = str(error)
    except OSError as error:
        _unwritten(error, result)
    try:
        manifest.finish()
    except OSError as error:
        _unwritten(error, result)


def _unwritten(error: OSError, result: Made) -> None:
    result.ended = result.ended or f"the manifest cannot be written: {one_line(error)}"
    result.left = max(1, result.left)


def _count(outcome: ItemOutcome, result: Made, bar: "tqdm[Any]") -> None:
    if outcome.failed is None:
        result.made += 1
        result.events += outcome.record["events"]
    else:
        result.failed += 1
        _tell(bar, outcome.item.clip.name, outcome.failed)
    bar.set_postfix_str(f"{result.made} items, {short(result.events)} events", refresh=False)


def _not_there(items: Sequence[Item], manifest: SetManifest, out: Path) -> list[Item]:
    """Those without an item; what failed is tried again. Raises UsageError for a set of another spec."""
    wanted = []
    for item in items:
        record = manifest.records.get(item.key)
        if record is None or "failed" in record:
            wanted.append(item)
            continue
        if record["digest"] != item.digest or record["path"] != item.path:
            raise UsageError(
                f"{out} was begun with another spec, {record['path']} differs: give another folder, or the "
                f"spec in {out / SPEC}"
            )
        if not (out / item.path).exists():
            wanted.append(item)
    return wanted


def _looked_at(items: Sequence[Item], spec: Spec) -> Iterator[Probed]:
    """Each clip of these; what is wrong is said at once."""
    clips = list(dict.fromkeys(item.clip for item in items))
    with tqdm(total=len(clips), desc="looking", unit=" inputs", disable=None, leave=False) as bar:
        for one in probed(clips, spec.seconds):
            if one.problem:
                _tell(bar, one.clip.name, one.problem)
            bar.update()
            yield one


def _begin(out: Path, spec: Spec) -> None:
    """Leave the spec with the set, and nothing of what a run before had under way."""
    shutil.rmtree(out / ASIDE, ignore_errors=True)
    try:
        (out / SPEC).write_text(spec.model_dump_json(indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{out / SPEC} cannot be written: {error.strerror}") from None


def _tell(bar: "tqdm[Any]", name: str, problem: str) -> None:
    text = problem if name in problem else f"{name}: {problem}"
    bar.write(f"voltcam: {text}", file=sys.stderr)


def _bar(frames: int) -> "tqdm[Any]":
    return tqdm(total=frames or None, unit=" frames", smoothing=0.05, disable=None, leave=False)


@contextmanager
def _ended_by_signals(engine: Engine, stop: threading.Event, bar: "tqdm[Any]") -> Iterator[None]:
    def end() -> None:
        if stop.is_set():
            engine.close()
            raise KeyboardInterrupt
        stop.set()
        bar.write("ending: what is under way is made first; Ctrl-C again ends at once", file=sys.stderr)

    with ended_by_signal(end):
        yield
