"""One packet of each kind by dv-processing's NetworkWriter, on a port: `python network_writer.py KIND PORT`.

A process of its own, since the writer holds the interpreter for seconds.
"""

import os
import sys
import time

import dv_processing as dv
import numpy as np

SOURCE, SIZE = "DAVIS346_X", (346, 260)


def _events(writer: dv.io.NetworkWriter) -> None:
    events = dv.EventStore()
    events.push_back(1_000_000, 1, 2, True)
    events.push_back(1_000_005, 3, 4, False)
    writer.writeEvents(events)


def _frame(writer: dv.io.NetworkWriter) -> None:
    frame = dv.Frame(1_000_000, np.arange(12, dtype=np.uint8).reshape(3, 4))
    frame.source = dv.FrameSource.SENSOR
    writer.writeFrame(frame)


def _imu(writer: dv.io.NetworkWriter) -> None:
    samples = dv.IMUPacket.ImuVector()
    for t in (1_000_000, 1_000_001):
        samples.append(dv.IMU(t, 25.5, 1, 2, 3, 4, 5, 6, 7, 8, 9))
    writer.writeImu(samples)


def _triggers(writer: dv.io.NetworkWriter) -> None:
    triggers = dv.TriggerPacket.TriggersVector()
    triggers.append(dv.Trigger(1_000_000, dv.TriggerType.EXTERNAL_SIGNAL_RISING_EDGE))
    triggers.append(dv.Trigger(1_000_001, dv.TriggerType.APS_EXPOSURE_END))
    writer.writeTriggers(triggers)


STREAMS = {
    "EVTS": (lambda: dv.io.Stream.EventStream(0, "events", SOURCE, SIZE), _events),
    "FRME": (lambda: dv.io.Stream.FrameStream(0, "frames", SOURCE, SIZE), _frame),
    "IMUS": (lambda: dv.io.Stream.IMUStream(0, "imu", SOURCE), _imu),
    "TRIG": (lambda: dv.io.Stream.TriggerStream(0, "triggers", SOURCE), _triggers),
}

if __name__ == "__main__":
    make_stream, write = STREAMS[sys.argv[1]]
    writer = dv.io.NetworkWriter("127.0.0.1", int(sys.argv[2]), make_stream())
    sys.stdout.write("listening\n")
    sys.stdout.flush()
    ends_s = time.monotonic() + 30
    while not writer.getClientCount() and time.monotonic() < ends_s:
        time.sleep(0.01)
    write(writer)
    sys.stdin.read()
    os._exit(0)  # the writer's own end takes long
