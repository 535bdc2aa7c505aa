"""dv-processing's NetworkReader: `python network_reader.py events PORT COUNT FILE`, a process of its own.

It says "NAME of WIDTH x HEIGHT" when it is connected, and saves what came: so many events, or frames.
"""

import sys
import time

import dv_processing as dv
import numpy as np


def events(reader: dv.io.NetworkReader, count: int) -> dict[str, np.ndarray]:
    batches = []
    while count > 0 and reader.isRunning():
        batch = reader.getNextEventBatch()
        if batch is None:
            time.sleep(0.001)
            continue
        batches.append(batch.numpy())
        count -= batch.size()
    return {"events": np.concatenate(batches)}


def frames(reader: dv.io.NetworkReader, count: int) -> dict[str, np.ndarray]:
    came = []
    while len(came) < count and reader.isRunning():
        frame = reader.getNextFrame()
        if frame is None:
            time.sleep(0.001)
            continue
        came.append(frame)
    return {
        "images": np.stack([frame.image for frame in came]),
        "t_us": np.array([frame.timestamp for frame in came]),
        "exposure_us": np.array([frame.exposure.total_seconds() * 1e6 for frame in came]),
    }


def imu(reader: dv.io.NetworkReader, count: int) -> dict[str, np.ndarray]:
    rows = []
    while len(rows) < count and reader.isRunning():
        for each in reader.getNextImuBatch() or ():
            accel = (each.accelerometerX, each.accelerometerY, each.accelerometerZ)
            gyro = (each.gyroscopeX, each.gyroscopeY, each.gyroscopeZ)
            rows.append((each.timestamp, each.temperature, *accel, *gyro))
    return {"samples": np.array(rows)}


def triggers(reader: dv.io.NetworkReader, count: int) -> dict[str, np.ndarray]:
    rows = []
    while len(rows) < count and reader.isRunning():
        rows += [(each.timestamp, each.type.value) for each in reader.getNextTriggerBatch() or ()]
    return {"triggers": np.array(rows)}


if __name__ == "__main__":
    kind, port, count, file = sys.argv[1:]
    reader = dv.io.NetworkReader("127.0.0.1", int(port))
    size = reader.getEventResolution() or reader.getFrameResolution() or (0, 0)
    sys.stdout.write("{} of {} x {}\n".format(reader.getCameraName(), *size))
    sys.stdout.flush()
    read = {"events": events, "frames": frames, "imu": imu, "triggers": triggers}[kind]
    np.savez(file, **read(reader, int(count)))
