"""What a DAVIS gives beside events and frames: samples of its inertial measurement unit, and triggers.

A message of the topics imu and triggers is a header, {header {stamp, frame_id}, seq, count}, and a buffer of
so many records, which are packed as the dtypes here say.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from voltcam_client.encodings import Buffer
from voltcam_client.errors import PacketError
from voltcam_client.headers import pack_header, ros_header, stamp_ns_of, unpack_header

TOPIC_IMU = b"imu"
TOPIC_TRIGGERS = b"triggers"

IMU = np.dtype([("t", "<i8"), ("temperature_c", "<f4"), ("accel_g", "<f4", 3), ("gyro_deg_s", "<f4", 3)])
"""One sample: time in us, temperature of the chip, acceleration and rotation along x, y, z of the camera.

x goes right, y down and z along the view, as pixels do. A camera at rest feels the pull of its support:
(0, -1, 0) g where it stands upright.
"""

TRIGGER = np.dtype([("t", "<i8"), ("kind", "u1")])
"""One trigger: time in us, and one of TRIGGER_KINDS."""

TRIGGER_KINDS: Final = {
    "rising edge": 1,
    "falling edge": 2,
    "frame begins": 6,
    "frame ends": 7,
    "exposure begins": 8,
    "exposure ends": 9,
}
"""The numbers of dv-processing's `TriggerType`, which are those of a DAVIS' driver."""

ImuSamples = npt.NDArray[np.void]
Triggers = npt.NDArray[np.void]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SamplesMessage:
    """Some successive IMU samples, or triggers, of one camera.

    - `samples`: (N,) IMU or TRIGGER, in order of time.
    - `seq`: counts messages of the topic, so that a gap is a loss.
    - `stamp_ns`: the host's clock when the message was made, ns since 1970.
    - `frame_id`: the camera's name.
    """

    samples: npt.NDArray[np.void]
    seq: int
    stamp_ns: int
    frame_id: str = "voltcam"


def encode_samples(message: SamplesMessage) -> tuple[bytes, bytes]:
    """Header and buffer."""
    header = {
        "header": ros_header(message.stamp_ns, message.frame_id),
        "seq": message.seq,
        "count": message.samples.size,
    }
    return pack_header(header), message.samples.tobytes()


def decode_imu(header_bytes: Buffer, buffer: Buffer) -> SamplesMessage:
    """IMU samples of a header and a buffer. PacketError if they are not such."""
    return _decode(header_bytes, buffer, IMU)


def decode_triggers(header_bytes: Buffer, buffer: Buffer) -> SamplesMessage:
    """Triggers of a header and a buffer. PacketError if they are not such."""
    return _decode(header_bytes, buffer, TRIGGER)


def _decode(header_bytes: Buffer, buffer: Buffer, dtype: np.dtype[Any]) -> SamplesMessage:
    header = unpack_header(header_bytes)
    try:
        if len(buffer) != header["count"] * dtype.itemsize:
            raise PacketError(f"{len(buffer)} bytes are not {header['count']} records: the message is cut")
        return SamplesMessage(
            samples=np.frombuffer(buffer, dtype),
            seq=header["seq"],
            stamp_ns=stamp_ns_of(header),
            frame_id=header["header"]["frame_id"],
        )
    except (KeyError, TypeError) as error:
        raise PacketError(
            f"the message's header lacks or misuses {error}; is it a Voltcam daemon?"
        ) from error
