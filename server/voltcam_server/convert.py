"""Frames to an event file: offline, as fast as possible, no frame left out."""

import contextlib
import math
import threading
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from tqdm import tqdm

from voltcam_client.formats import READABLE, Recording, Writer, left_out, open_writer, read, suffix_of
from voltcam_client.formats.rosbag import METADATA
from voltcam_client.formats.spool import PARTIAL
from voltcam_client.meter import short
from voltcam_simulator import Camera, Device, Law, NoDeviceError, Simulator
from voltcam_video import (
    Frame,
    Outcome,
    Source,
    SourceError,
    SourceRequest,
    Upsampling,
    between,
    fit,
    open_source,
)
from voltcam_video.sources import MemorySource
from voltcam_video.sources.photos import PhotosSource

from .cores import threads_for
from .ground_truth import GroundTruthWriter
from .problems import UsageError, one_line
from .signals import ended_by_signal


@dataclass(frozen=True)
class Conversion:
    """What is to be done. seconds: of the source's time, None for all of it. truth: where flow and order of a
    scene from photographs go.
    """

    source: SourceRequest
    camera: Camera
    output: Path
    law: Law = "exact"
    device: Device = "cpu"
    seed: int = 0
    upsample: Upsampling = "cubic"
    seconds: float | None = None
    overwrite: bool = False
    copy: bool = False  # a recording with frames is copied, too, not simulated
    truth: Path | None = None


def convert(job: Conversion) -> str:
    """Simulate the source's frames into the output, or copy a recording that has none; says what was done.

    SIGINT and SIGTERM end it early, with the output finished. Raises UsageError when the source cannot be
    read, FormatError and RecordingError as the output's writer does; what came before is in the output.
    """
    path = Path(job.source.uri)
    if job.truth is not None and job.source.photo_folder is None:
        raise UsageError(
            f"{job.source.shown}: flow and order are known of photos:FOLDER only; leave --truth away"
        )
    if job.copy:
        return _copy(read(path), job)
    recording = _recording(path)
    if recording is not None and (recording.frames is None or path.suffix == PARTIAL):
        return _copy(recording, job)
    stop = threading.Event()
    try:
        with ended_by_signal(stop.set), _source(recording, job, stop) as source:
            if job.seconds is None and source.endless:
                raise UsageError(f"{job.source.shown} does not end by itself: give --seconds")
            return _simulate(source, job, stop)
    except SourceError as error:
        raise UsageError(one_line(error)) from None


def _simulate(source: Source, job: Conversion, stop: threading.Event) -> str:
    width, height = job.camera.width, job.camera.height
    try:
        simulator = Simulator(
            width,
            height,
            job.camera.parameters.seen_through(source.gamma),
            job.law,
            job.seed,
            threads_for(width, height),
            job.device,
        )
    except NoDeviceError as error:
        raise UsageError(one_line(error)) from None
    frames, began_s = 0, time.monotonic()

    def fitted() -> Iterator[Frame]:
        nonlocal frames
        last_us: int | None = None
        for frame in _progress(_until(source, job.seconds, stop), source, writer):
            if last_us is not None and frame.t_us <= last_us:
                raise ValueError(f"its time, {frame.t_us} us, does not come after the last one, {last_us} us")
            if truth is not None:
                truth.frame(frame.image, frame.t_us)
            yield replace(frame, image=fit(frame.image, width, height, job.source.fit))
            frames, last_us = frames + 1, frame.t_us

    with (
        open_writer(job.output, width=width, height=height, overwrite=job.overwrite) as writer,
        _truth(source, job) as truth,
    ):
        try:
            frames_between = between(fitted(), job.upsample)
            for events in simulator.stream((frame.image, frame.t_us) for frame in frames_between):
                writer.events(events)
        except (SourceError, ValueError) as error:
            where = "" if isinstance(error, SourceError) else f"{job.source.shown}, frame {frames}: "
            kept = f"the {writer.event_count} events before it are kept in {job.output}"
            raise UsageError(f"{where}{one_line(error)}; {kept}") from None
    took_s = time.monotonic() - began_s
    done = f"{job.output}: {writer.event_count} events from {frames} frames in {took_s:.1f} s"
    return "; ".join(filter(None, [done, left_out(job.output, frames=False)]))


def _until(source: Source, seconds: float | None, stop: threading.Event) -> Iterator[Frame]:
    first_us: int | None = None
    while not stop.is_set() and (frame := source.read()) is not None:
        first_us = frame.t_us if first_us is None else first_us
        if seconds is not None and frame.t_us - first_us > seconds * 1e6:
            return
        yield frame
        if frame.sent is not None:
            frame.sent.tell(Outcome("simulated"))


def _progress(frames: Iterator[Frame], source: Source, writer: Writer) -> Iterator[Frame]:
    """The same frames; on a terminal, under a progress bar."""
    total = source.granted.get("frames")
    with tqdm(frames, total=total, unit=" frames", disable=None, leave=False) as bar:
        for frame in bar:
            yield frame
            bar.set_postfix_str(f"{short(writer.event_count)} events", refresh=False)


def _source(recording: Recording | None, job: Conversion, stop: threading.Event) -> Source:
    if recording is None or recording.frames is None or recording.frame_t_us is None:
        return open_source(_of_the_camera_s_size(job), stop=stop)
    return MemorySource(job.source, recording.frames, recording.frame_t_us, stop=stop)


def _of_the_camera_s_size(job: Conversion) -> SourceRequest:
    """What is made of photographs is made pixel for pixel, so that its flow is that of the events."""
    if job.source.photo_folder is None:
        return job.source
    return job.source.model_copy(update={"width": job.camera.width, "height": job.camera.height})


def _truth(source: Source, job: Conversion) -> contextlib.AbstractContextManager[GroundTruthWriter | None]:
    if job.truth is None or not isinstance(source, PhotosSource):
        return contextlib.nullcontext()
    try:
        return GroundTruthWriter(job.truth, source.scene, job.source.shown, overwrite=job.overwrite)
    except FileExistsError:
        raise UsageError(f"{job.truth} exists: give another name, or --overwrite") from None
    except OSError as error:
        raise UsageError(f"{job.truth}: {one_line(error)}") from None


def _recording(path: Path) -> Recording | None:
    """The recording at `path`, unless it is one whose frames voltcam_video reads by itself."""
    if path.is_dir():
        only_events = (path / "events.txt").exists() and not (path / "images.txt").exists()
        in_folder = only_events or path.suffix == PARTIAL or (path / METADATA).exists()
        return read(path) if in_folder else None
    suffix = suffix_of(path)
    if suffix == ".npz" and zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            return None if "frames.npy" in archive.namelist() else read(path)
    return read(path) if path.is_file() and suffix in READABLE and suffix != ".npz" else None


def _copy(recording: Recording, job: Conversion) -> str:
    width, height = max(1, recording.width), max(1, recording.height)
    with open_writer(job.output, width=width, height=height, overwrite=job.overwrite) as writer:
        last_us = _last_us(recording, job.seconds)
        writer.events(recording.events[recording.events["t"] <= last_us])
        if recording.frames is not None and recording.frame_t_us is not None:
            for number, (image, t_us) in enumerate(zip(recording.frames, recording.frame_t_us, strict=True)):
                if t_us > last_us:
                    break
                if recording.exposure_us is None:
                    writer.frame(image, int(t_us))
                else:
                    begin_us, end_us = recording.exposure_us[number].tolist()
                    writer.aps_frame(image, (begin_us, end_us))
    done = f"{job.output}: {writer.event_count} events copied from {job.source.uri}, nothing simulated"
    images = f"{len(recording.image_paths)} images are not copied" if recording.image_paths else ""
    return "; ".join(filter(None, [done, images, left_out(job.output, frames=recording.frames is not None)]))


def _last_us(recording: Recording, seconds: float | None) -> float:
    """Of what is wanted, so many seconds from its first event or frame."""
    times = [
        t_us[0] for t_us in (recording.events["t"], recording.frame_t_us) if t_us is not None and t_us.size
    ]
    return math.inf if seconds is None or not times else float(min(times)) + seconds * 1e6
