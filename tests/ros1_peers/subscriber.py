"""A subscriber of rospy's, which prints each message as JSON: subscriber.py COUNT TOPIC PACKAGE/TYPE ...

COUNT: of each topic; then it ends.
"""

import importlib
import json
import sys
import threading

import genpy
import rospy


def as_json(value):
    if isinstance(value, genpy.Message):
        return {name: as_json(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, genpy.Time):
        return value.to_nsec()
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, (list, tuple)):
        return [as_json(each) for each in value]
    return value


def main():
    count, topics = int(sys.argv[1]), sys.argv[2:]
    lock, done = threading.Lock(), threading.Event()
    left = dict.fromkeys(topics[::2], count)

    def heard(message, topic):
        with lock:
            if left[topic]:
                left[topic] -= 1
                sys.stdout.write(json.dumps([topic, as_json(message)]) + "\n")
                sys.stdout.flush()
            if not any(left.values()):
                done.set()

    rospy.init_node("subscriber", anonymous=True)
    for topic, name in zip(topics[::2], topics[1::2], strict=True):
        package, _, kind = name.partition("/")
        cls = getattr(importlib.import_module(package + ".msg"), kind)
        rospy.Subscriber(topic, cls, heard, topic, queue_size=1000)
    done.wait(60)


main()
