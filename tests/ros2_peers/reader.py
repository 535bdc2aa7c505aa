"""A program of DDS without Voltcam: `python reader.py TOPIC TYPE COUNT FILE [best_effort] [telling]`.

Its types are written as in IDL, and Cyclone's own deserialiser reads them, field by field. It says when a
writer is found (telling: and each time a message came), and saves the fields as JSON lines, bytes as hex.
"""

import dataclasses
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from idl_messages import CameraInfo, EventArray, EventPacket, Image, Imu

TYPES = {each.__name__: each for each in (EventPacket, EventArray, Image, CameraInfo, Imu)}


def plain(value: Any) -> Any:
    """Fields by name; bytes as hex."""
    if isinstance(value, IdlStruct):
        return {
            field.name: plain(getattr(value, field.name))
            for field in dataclasses.fields(value)  # type: ignore[arg-type]
        }
    if isinstance(value, (bytes, bytearray)):
        return bytes(value).hex()
    if isinstance(value, (list, tuple)):
        whole = value and all(isinstance(each, int) and 0 <= each < 256 for each in value)
        return bytes(value).hex() if whole else [plain(each) for each in value]
    return value


if __name__ == "__main__":
    name, kind, count, file, *options = sys.argv[1:]
    participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
    best_effort = "best_effort" in options
    reliability = Policy.Reliability.BestEffort if best_effort else Policy.Reliability.Reliable(0)
    reader = DataReader(
        participant,
        Topic(participant, name, TYPES[kind]),
        Qos(reliability, Policy.Durability.Volatile, Policy.History.KeepLast(1000)),
    )
    while not reader.get_matched_publications():
        time.sleep(0.01)
    sys.stdout.write("found\n")
    sys.stdout.flush()
    came = reader.take_iter(timeout=duration(seconds=20))
    with Path(file).open("w") as lines:
        for _, message in zip(range(int(count)), came, strict=False):
            lines.write(json.dumps(plain(message)) + "\n")
            if "telling" in options:
                sys.stdout.write("one\n")
                sys.stdout.flush()
