"""A client-side recording: a running camera's packets and frames into a file."""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from voltcam_client.camera import EventCamera
from voltcam_client.errors import VoltcamError
from voltcam_client.formats import open_writer
from voltcam_client.formats.spool import PARTIAL
from voltcam_client.packet import Packet

TICK_S = 0.1  # the longest wait before `stop` is asked again


@dataclass
class Progress:
    """How far a recording has come."""

    seconds: float = 0.0
    events: int = 0
    frames: int = 0
    lost_packets: int = 0


def record(
    url: str,
    path: str | Path,
    *,
    seconds: float | None = None,
    frames: bool = True,
    overwrite: bool = False,
    stop: Callable[[], bool] = lambda: False,
    show: Callable[[Progress], None] = lambda progress: None,
) -> Progress:
    """Record the camera at `url` into `path`, in its suffix's format, until `seconds` are over or `stop()`.

    `seconds` count from the first packet; one that does not come within them is a TimeoutError. `show` is
    called for every packet. Frames are left out where the format holds none.

    Raises FormatError and RecordingError as `open_writer` and its Writer do (the file exists, the disk is
    full), and VoltcamError when the camera was started anew with another size or an earlier clock. Whatever
    ends it, what came before is in the file.
    """
    with ExitStack() as stack:
        camera = stack.enter_context(EventCamera(url))
        packets = _packets(camera, seconds, stop)
        first = next((packet for packet in packets if packet is not None), None)
        if first is None:
            raise TimeoutError(
                f"no packet from {url}, nothing is recorded: is `voltcam serve` running there?"
            )
        begin = time.monotonic()
        writer = stack.enter_context(
            open_writer(path, width=first.width, height=first.height, overwrite=overwrite)
        )
        stream = stack.enter_context(camera.frames()) if frames and writer.holds_frames else None
        samples = [
            (stack.enter_context(beside()), write)
            for beside, write in ((camera.imu, writer.imu), (camera.triggers, writer.triggers))
            if writer.holds_samples
        ]
        progress = Progress()
        previous = first
        for packet in chain([first], packets):
            if packet is not None:
                _check_same_camera(previous, packet, url, path)
                writer.events(packet.events)
                progress.events += packet.events.size
                previous = packet
            while stream is not None and (frame := stream.receive(0)) is not None:
                if frame.exposure_us is None:
                    writer.frame(frame.image, frame.t_us)
                else:
                    writer.aps_frame(frame.image, frame.exposure_us, frame.frame_us)
                progress.frames += 1
            for beside, write in samples:
                while (some := beside.receive(0)) is not None:
                    write(some.samples)
            progress.lost_packets = camera.lost_packets
            progress.seconds = time.monotonic() - begin
            show(progress)
        return progress


def size_bytes(path: Path) -> int:
    """What a recording takes on the disk, under way or done."""
    partial = path.with_name(path.name + PARTIAL)
    files = partial.iterdir() if partial.is_dir() else [path]
    return sum(file.stat().st_size for file in files)


def _packets(camera: EventCamera, seconds: float | None, stop: Callable[[], bool]) -> Iterator[Packet | None]:
    """The camera's packets, and None whenever TICK_S goes by without one, for `seconds` after the first."""
    begin, waiting = time.monotonic(), True
    while not stop() and (seconds is None or time.monotonic() - begin < seconds):
        packet = camera.receive(TICK_S)
        if waiting and packet is not None:
            begin, waiting = time.monotonic(), False
        yield packet


def _check_same_camera(previous: Packet, packet: Packet, url: str, path: str | Path) -> None:
    if (packet.width, packet.height) != (previous.width, previous.height):
        change = f"is now {packet.width}x{packet.height}, not {previous.width}x{previous.height}"
    elif packet.time_base_ns < previous.time_base_ns:
        change = "was started anew, its clock went back"
    else:
        return
    raise VoltcamError(f"the camera at {url} {change}: {path} holds what came before, record on into another")
