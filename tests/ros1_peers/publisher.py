"""A publisher of rospy's: publisher.py TOPIC PACKAGE/TYPE publishes what it reads, and says so.

Each line is JSON: the stamp in ns, and the fields; of bytes as hexadecimal.
"""

import importlib
import json
import sys

import rospy


def main():
    topic, name = sys.argv[1:]
    package, _, kind = name.partition("/")
    cls = getattr(importlib.import_module(package + ".msg"), kind)
    rospy.init_node("publisher", anonymous=True, disable_signals=True)
    publisher = rospy.Publisher(topic, cls, queue_size=100)
    for line in sys.stdin:
        while publisher.get_num_connections() == 0:
            rospy.rostime.wallsleep(0.02)
        stamp_ns, fields = json.loads(line)
        message = cls(**{key: value for key, value in fields.items() if key != "data"})
        message.data = bytes.fromhex(fields["data"])
        message.header.stamp = rospy.Time(*divmod(stamp_ns, 1_000_000_000))
        publisher.publish(message)
        sys.stdout.write("published\n")
        sys.stdout.flush()


main()
