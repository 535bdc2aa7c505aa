"""Who a node is in the graph of ROS 1: names, and what the environment and `NAME:=VALUE` say of them."""

import os
import re
import socket
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Self
from urllib.parse import urlsplit

from voltcam_client.ros1 import RosError

DEFAULT_MASTER = "http://localhost:11311"
_NAME = re.compile(r"[~/A-Za-z][\w/]*", re.ASCII)
_LOOPBACK = ("127.", "localhost")


@dataclass(frozen=True, slots=True)
class Names:
    """node: its whole name. host: how other nodes reach this machine; None: as the roscore does."""

    master: str
    node: str
    host: str | None = None
    remapped: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(
        cls, name: str, remappings: Sequence[str] = (), environment: Mapping[str, str] | None = None
    ) -> Self:
        """As rospy would: `__name:=`, `__ns:=`, `__master:=`, `__ip:=`, `__hostname:=` over ROS_...

        Raises RosError.
        """
        env = os.environ if environment is None else environment
        given = dict(_split(text) for text in remappings)
        space = given.get("__ns") or env.get("ROS_NAMESPACE") or "/"
        space = _clean("/" + space) + "/"
        relative = {key: value for key, value in given.items() if not key.startswith("__")}
        node = _clean(space + (given.get("__name") or name))
        bare = cls(master="", node=node)
        return cls(
            master=given.get("__master") or env.get("ROS_MASTER_URI") or DEFAULT_MASTER,
            node=node,
            host=given.get("__ip") or given.get("__hostname") or env.get("ROS_HOSTNAME") or env.get("ROS_IP"),
            remapped={bare.resolved(key): bare.resolved(value) for key, value in relative.items()},
        )

    def resolved(self, name: str) -> str:
        """The whole name of a topic, remapped where it is to be. Raises RosError for what is no name."""
        if not _NAME.fullmatch(name):
            raise RosError(f"{name!r} is no name of ROS 1: give one such as /dvs/events")
        if name.startswith("~"):
            whole = f"{self.node}/{name[1:]}"
        elif name.startswith("/"):
            whole = name
        else:
            whole = f"{self.node.rpartition('/')[0]}/{name}"
        whole = _clean(whole)
        return self.remapped.get(whole, whole)

    def own_host(self) -> str:
        """What other nodes are told. Raises RosError where there is no way to a roscore."""
        if self.host:
            return self.host
        try:
            parts = urlsplit(self.master)
            # Nothing is sent: the system says from which address it would be.
            family, _, _, _, address = socket.getaddrinfo(parts.hostname, parts.port or 80, socket.AF_INET)[0]
            with socket.socket(family, socket.SOCK_DGRAM) as probe:
                probe.connect(address)
                return str(probe.getsockname()[0])
        except (OSError, ValueError) as error:
            raise RosError(f"no way to a roscore at {self.master} ({error}): set ROS_MASTER_URI") from None


def bind_address(host: str) -> str:
    """Where to listen, told `host`: on this machine only where that is what others are told."""
    return "127.0.0.1" if host.startswith(_LOOPBACK) else ""


def _split(text: str) -> tuple[str, str]:
    key, _, value = text.partition(":=")
    if re.match("_[^_]", key):
        raise RosError(f"{text}: there are no private parameters here: give an option, see --help")
    if not value:
        raise RosError(f"{text}: nothing follows := there")
    return key, value


def _clean(name: str) -> str:
    return "/" + "/".join(part for part in name.split("/") if part)
