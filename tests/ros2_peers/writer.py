"""A program of DDS that publishes images: `python writer.py TOPIC Image|CompressedImage [best_effort]`.

Its types are written as in IDL, and Cyclone's own serialiser packs them. Each line of its input is a message:
[t_us, {field: value}], bytes as hex. It says "found" when a reader is there, and "one" after each message.
"""

import json
import os
import sys
import time

from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from idl_messages import CompressedImage, Header, Image, Time

if __name__ == "__main__":
    name, kind, *options = sys.argv[1:]
    type_ = {"Image": Image, "CompressedImage": CompressedImage}[kind]
    participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
    reliable = Policy.Reliability.Reliable(duration(seconds=10))
    reliability = Policy.Reliability.BestEffort if "best_effort" in options else reliable
    writer = DataWriter(
        participant,
        Topic(participant, name, type_),
        Qos(reliability, Policy.Durability.Volatile, Policy.History.KeepLast(10)),
    )
    while not writer.get_matched_subscriptions():
        time.sleep(0.01)
    sys.stdout.write("found\n")
    sys.stdout.flush()
    for line in sys.stdin:
        t_us, fields = json.loads(line)
        header = Header(Time(t_us // 1_000_000, t_us % 1_000_000 * 1000), "camera")
        fields["data_"] = list(bytes.fromhex(fields["data_"]))
        writer.write(type_(header_=header, **fields))
        sys.stdout.write("one\n")
        sys.stdout.flush()
