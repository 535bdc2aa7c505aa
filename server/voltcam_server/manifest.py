"""Beside each recording, how it was made: FILE.manifest.jsonl, and what makes the same events again.

The first line says software, camera, law, seed, source and parameters; further ones what was not as always:
parameters that changed, intervals without events, longer steps; the last one counts and checksum. Each line
is on the disk before the next frame. FILE.state.npz is the sensor at the beginning (`Simulator.snapshot`),
FILE.frames32 has the frames of a source that is finer than 8 bits, as (n, height, width) float32.
"""

import hashlib
import importlib.metadata
import json
import platform
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from voltcam_client.formats.writer import AppendFile

from .interval import Interval, SimulationSetup, Start
from .problems import UsageError, one_line

FORMAT = 1
SOFTWARE = ("voltcam", "numpy", "numba", "opencv-contrib-python-headless")
USUAL = ("advanced", 1.0)  # an interval of which nothing need be said


def paths_of(recording: Path) -> tuple[Path, Path, Path]:
    """Manifest, state and frames beside a recording."""
    manifest, state, frames = (
        recording.with_name(recording.name + suffix)
        for suffix in (".manifest.jsonl", ".state.npz", ".frames32")
    )
    return manifest, state, frames


def software() -> dict[str, str]:
    """What the events depend on, beside the frames."""
    versions = {name: importlib.metadata.version(name) for name in SOFTWARE}
    return versions | {"python": platform.python_version(), "machine": platform.machine()}


class ManifestWriter:
    """Made when the recording is; replaces what is left of one that is gone. Raises OSError."""

    def __init__(self, recording: Path, setup: SimulationSetup, start: Start) -> None:
        manifest, state, frames = paths_of(recording)
        self._manifest = AppendFile(manifest, overwrite=True)
        with state.open("wb") as file:
            np.savez(file, **start.state)  # type: ignore[arg-type]
        frames.unlink(missing_ok=True)
        self._frames32: AppendFile | None = None
        self._frames32_path = frames
        self._version, self._count = start.parameters_version, 0
        self._checksum = hashlib.sha256()
        self._say(
            manifest=FORMAT,
            began=time.strftime("%Y-%m-%dT%H:%M:%S%z"),
            software=software(),
            camera=setup.camera.name,
            width=setup.camera.width,
            height=setup.camera.height,
            law=setup.law,
            seed=setup.seed,
            upsample=setup.upsample,
            recorded_frames=setup.frames,
            source=start.source,
            follows=start.follows,
            parameters_version=start.parameters_version,
            parameters=start.parameters.model_dump(),
        )

    def interval(self, interval: Interval) -> None:
        """One that the recording has now. Raises OSError."""
        said: dict[str, Any] = {}
        if (interval.how, interval.coarser) != USUAL:
            said |= {"how": interval.how, "coarser": interval.coarser}
        if interval.parameters_version != self._version:
            self._version = interval.parameters_version
            said |= {"parameters_version": self._version, "parameters": interval.parameters.model_dump()}
        if said:
            self._say(frame=self._count, t_us=interval.frame_us, **said)
        if interval.image.dtype != np.uint8:
            self._keep(interval.image.astype(np.float32, copy=False))
        self._checksum.update(interval.events.tobytes())
        self._count += 1

    def close(self, events: int, ended: str) -> None:
        """ended: why. Raises OSError."""
        self._say(frames=self._count, events=events, sha256=self._checksum.hexdigest(), ended=ended)
        self._manifest.close()
        if self._frames32 is not None:
            self._frames32.close()

    def _keep(self, image: NDArray[np.float32]) -> None:
        if self._frames32 is None:
            self._frames32 = AppendFile(self._frames32_path, overwrite=True)
        self._frames32.append(image.tobytes())

    def _say(self, **said: Any) -> None:
        self._manifest.append((json.dumps(said) + "\n").encode())


@dataclass(frozen=True)
class Manifest:
    """A manifest, read. head: its first line. notes: by frame. end: its last line, empty after a crash."""

    head: dict[str, Any]
    notes: dict[int, dict[str, Any]]
    end: dict[str, Any]

    @classmethod
    def read(cls, recording: Path) -> "Manifest":
        """That of a recording. Raises UsageError where there is none."""
        path = paths_of(recording)[0]
        try:
            lines = [json.loads(line) for line in path.read_text().splitlines()]
            head = lines[0]
            if head["manifest"] != FORMAT:
                raise UsageError(f"{path} is of format {head['manifest']}, this program knows {FORMAT}")
        except OSError as error:
            raise UsageError(
                f"{path} cannot be read: {error.strerror}: only recordings of a daemon (--record, or POST "
                "/api/v1/recording) have a manifest"
            ) from None
        except (ValueError, LookupError, TypeError, RecursionError) as error:
            raise UsageError(f"{path} is no manifest of a recording: {one_line(error)}") from None
        notes = {line["frame"]: line for line in lines[1:] if "frame" in line}
        end = lines[-1] if "sha256" in lines[-1] else {}
        return cls(head, notes, end)
