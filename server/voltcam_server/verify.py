"""The events of a recording, made again from its frames and its manifest, and held against those in it."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats import Recording, read
from voltcam_simulator import Limits, Parameters, Simulator
from voltcam_video import Frame, along_flow

from .cores import threads_for
from .manifest import Manifest, paths_of, software
from .problems import UsageError


@dataclass(frozen=True)
class Verdict:
    """frames, events: that were made again and are the same, bit for bit, up to the first that are not.

    difference: what is not the same, empty where all is. versions: of software that is another one now.
    """

    frames: int
    events: int
    difference: str
    versions: dict[str, tuple[str, str]]

    @property
    def words(self) -> str:
        """In a line."""
        made = f"{self.events} events of {self.frames} frames made again, the same bit for bit"
        others = ", ".join(f"{name} {was}, now {now}" for name, (was, now) in self.versions.items())
        return "; ".join(part for part in (made, self.difference, others and f"made with {others}") if part)


def verify(path: Path) -> Verdict:
    """Raises UsageError where a recording cannot be made again; FormatError and RecordingError as `read`."""
    manifest = Manifest.read(path)
    recording = read(path)
    images = _images(path, recording)
    head = manifest.head
    if head.get("recorded_frames", "source") != "source":
        raise UsageError(
            f"{path} has no frames of its source to make its events from: record --frames source"
        )
    if head["upsample"] == "cubic":
        raise UsageError(f"{path} was made with --upsample cubic, which needs frames that are not in it")
    now = software()
    versions = {
        name: (was, now.get(name, "none")) for name, was in head["software"].items() if was != now.get(name)
    }
    frames = made = 0
    for index, events in _again(path, manifest, images, recording.frame_t_us):
        if events is None:
            note = f"the interval of frame {index} was given up, and what is after it cannot be made again"
            return Verdict(frames, made, note, versions)
        wanted = recording.events[made : made + len(events)]
        if not np.array_equal(events, wanted):
            return Verdict(frames, made, f"from frame {index} on events differ", versions)
        frames, made = frames + 1, made + len(events)
    more = recording.events.size - made
    return Verdict(frames, made, f"{more} events are of no frame" if more else "", versions)


def _images(path: Path, recording: Recording) -> NDArray[Any]:
    """The frames as they were simulated."""
    if recording.frames is None or recording.frame_t_us is None:
        raise UsageError(f"{path} has no frames to make its events from: record .npz")
    exact = paths_of(path)[2]
    if not exact.exists():
        return recording.frames
    shape = (-1, recording.height, recording.width)
    return np.memmap(exact, np.float32, mode="r").reshape(shape)[: len(recording.frames)]


def _again(
    path: Path, manifest: Manifest, images: NDArray[Any], t_us: NDArray[np.int64] | None
) -> Iterator[tuple[int, Events | None]]:
    """Each frame's index and events; None where these cannot be known."""
    head = manifest.head
    assert t_us is not None
    parameters = Parameters.model_validate(head["parameters"])
    simulator = Simulator(
        head["width"], head["height"], parameters, head["law"], head["seed"],
        threads_for(head["width"], head["height"]),
    )  # fmt: skip
    with np.load(paths_of(path)[1], allow_pickle=False) as state:
        former: Frame | None = None
        if state.files:
            try:
                simulator.restore(state)
            except (KeyError, ValueError) as error:
                kept = paths_of(path)[1]
                raise UsageError(
                    f"{kept} is of another Voltcam: verify {path.name} with the one that recorded it"
                ) from error
            former = Frame(state["frame"], int(state["times_us"][0])) if head["follows"] else None
    for index, (image, time_us) in enumerate(zip(images, t_us.tolist(), strict=True)):
        note = manifest.notes.get(index, {})
        if "parameters" in note:
            simulator.parameters = Parameters.model_validate(note["parameters"])
        how = note.get("how", "advanced")
        frame = Frame(image, time_us)
        if how in ("given up", "replayed"):
            yield index, None
            return
        if how == "jumped":
            simulator.jump(image, time_us)
            yield index, np.empty(0, EVENT)
        else:
            limits = Limits(note.get("coarser", 1.0))
            steps = [*_between(former, frame, head["upsample"]), frame]
            yield index, np.concatenate([simulator.advance(s.image, s.t_us, limits) for s in steps])
        former = frame


def _between(former: Frame | None, frame: Frame, upsample: Any) -> Iterator[Frame]:
    if former is None or upsample in ("off", "linear"):
        return iter(())
    return along_flow(former, frame, upsample if isinstance(upsample, int) else None)
