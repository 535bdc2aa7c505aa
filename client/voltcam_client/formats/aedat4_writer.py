"""Writing `.aedat4`: events, frames, IMU samples and triggers, uncompressed, with numpy alone.

A packet is with the operating system when a call returns. The table of all packets follows on close; until
then, and after a crash, readers go from packet to packet.
"""

import contextlib
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from voltcam_client.dv.file import MAGIC, PACKET, mapped, table_of
from voltcam_client.dv.packets import (
    LARGEST_COORDINATE,
    events_packet,
    frame_packet,
    imu_packet,
    triggers_packet,
)
from voltcam_client.dv.streams import NO_TABLE, DvStream, camera_name, header_bytes
from voltcam_client.encodings import Events
from voltcam_client.errors import PacketError
from voltcam_client.formats.recording import FormatError
from voltcam_client.formats.writer import AppendFile, Writer, cannot_create
from voltcam_client.samples import ImuSamples, Triggers

_KINDS = {0: "EVTS", 1: "FRME", 2: "IMUS", 3: "TRIG"}
_HEADER_BYTES = 4096 - len(MAGIC) - len(MAGIC) % 4  # room for all streams


class Aedat4Writer(Writer):
    """Packets as they come. The header names the streams that there are so far, and where the table is."""

    holds_frames = True
    holds_samples = True

    def __init__(self, path: Path, width: int, height: int, *, overwrite: bool) -> None:
        super().__init__(path, width, height)
        if max(width, height) > LARGEST_COORDINATE + 1:
            raise FormatError(f"{path}: AEDAT4 holds {LARGEST_COORDINATE + 1} pixels a side at most")
        self._streams = {0}
        try:
            self._file = AppendFile(path, overwrite=overwrite)
            self._file.append(MAGIC + self._header())
        except OSError as error:
            raise cannot_create(path, error) from error

    def frame(self, image: NDArray[np.uint8], t_us: int) -> None:
        self.aps_frame(image, (t_us, t_us))

    def aps_frame(
        self,
        image: NDArray[np.uint8],
        exposure_us: tuple[int, int],
        frame_us: tuple[int, int] | None = None,
    ) -> None:
        self._check_image(image)
        self._put(1, frame_packet(image, exposure_us, frame_us))

    def imu(self, samples: ImuSamples) -> None:
        if samples.size:
            self._put(2, imu_packet(samples))

    def triggers(self, triggers: Triggers) -> None:
        if triggers.size:
            self._put(3, triggers_packet(triggers))

    def close(self) -> None:
        if self._closed:
            return
        super().close()
        try:
            if not self._failure:
                self._finish()
        finally:
            self._file.close()

    def _finish(self) -> None:
        """Append the table, then say where it is; what fails is taken back."""
        end = self.path.stat().st_size
        try:
            for piece in table_of(mapped(self.path), len(MAGIC) + _HEADER_BYTES, _KINDS):
                self._file.append(piece)
            self._rewrite_header(end)
        except OSError as error:
            with contextlib.suppress(OSError):
                os.truncate(self.path, end)
            raise self._failed(error) from error
        except PacketError:  # too many packets for a table: it reads without one
            return

    def _append(self, events: Events) -> None:
        packet = events_packet(events, PACKET.size)
        PACKET.pack_into(packet, 0, 0, len(packet) - PACKET.size)
        self._file.append(packet)

    def _put(self, stream: int, packet: bytes | bytearray) -> None:
        with self._writing():
            if stream not in self._streams:
                self._streams.add(stream)
                self._rewrite_header()
            self._file.append(PACKET.pack(stream, len(packet)) + packet)

    def _header(self, table: int = NO_TABLE) -> bytes:
        source = camera_name(self.width, self.height)
        sized = (self.width, self.height)
        streams = [DvStream(i, _KINDS[i], source, sized if i < 2 else None) for i in sorted(self._streams)]
        return header_bytes(streams, table, _HEADER_BYTES)

    def _rewrite_header(self, table: int = NO_TABLE) -> None:
        with self.path.open("r+b") as file:
            file.write(MAGIC + self._header(table))
