"""Where topics of ROS 2 are in DDS, and what the environment says of it, as to programs of ROS 2.

Sources: design.ros2.org/articles/topic_and_service_names.html; docs.ros.org, Improved Dynamic Discovery.
"""

import os
import re
from collections.abc import Mapping
from typing import NamedTuple, Self

from voltcam_client.ros2 import Ros2Error

NAME = re.compile(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", re.ASCII)
MOST_CHARACTERS = 200
LAST_DOMAIN = 232  # the ports of a later one would be above 65535 (DDSI-RTPS, 9.6.1)
RANGES = ("LOCALHOST", "SUBNET")


class Ros2Place(NamedTuple):
    """Of topics: a domain of DDS, and whether other machines are in it."""

    domain: int = 0
    subnet: bool = False

    @classmethod
    def of(cls, environment: Mapping[str, str] | None = None) -> Self:
        """As ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE have it. Without the latter this machine alone,
        which ROS 2 needs to be told. Raises Ros2Error."""
        env = os.environ if environment is None else environment
        domain = env.get("ROS_DOMAIN_ID") or "0"
        if not (domain.isdecimal() and domain.isascii() and len(domain) < 4 and int(domain) <= LAST_DOMAIN):
            raise Ros2Error(f"ROS_DOMAIN_ID is {domain[:40]!r}: give a whole number from 0 to {LAST_DOMAIN}")
        reach = env.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or RANGES[0]
        if reach not in RANGES:
            raise Ros2Error(f"ROS_AUTOMATIC_DISCOVERY_RANGE is {reach[:40]!r}: give {' or '.join(RANGES)}")
        return cls(int(domain), reach == "SUBNET")


def topic_name(name: str) -> str:
    """A topic's whole name in ROS 2, such as /dvs/events. Raises Ros2Error for what is none."""
    if not NAME.fullmatch(name) or "__" in name or len(name) > MOST_CHARACTERS:
        raise Ros2Error(f"{name[:80]!r} is no name of ROS 2: give one such as /camera/image_raw")
    return "/" + name.removeprefix("/")


def dds_name(name: str) -> str:
    """That of the same topic in DDS, such as rt/dvs/events. Raises Ros2Error."""
    return "rt" + topic_name(name)
