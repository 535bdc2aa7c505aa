"""How `voltcam bench transports` sends over ROS 1: as users do, by `voltcam ros1` in a process of its own."""

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

from voltcam_client.errors import VoltcamError
from voltcam_client.ros1.xml_rpc import RpcServer

END_S = 5.0


class Roscore:
    """As much of one as a node needs that only publishes. uris: of publishers, by topic."""

    def __init__(self) -> None:
        self.uris: dict[str, str] = {}
        self._changed = threading.Condition()
        methods: dict[str, Callable[..., Any]] = {
            "getPid": lambda caller: 1,
            "registerPublisher": self._register,
            "unregisterPublisher": lambda caller, topic, uri: 1,
        }
        self._server = RpcServer("127.0.0.1", methods)
        self.uri = f"http://127.0.0.1:{self._server.port}/"

    def publisher(self, topic: str, wait_s: float) -> str:
        """Its address, as soon as there is one. Raises VoltcamError."""
        with self._changed:
            if not self._changed.wait_for(lambda: topic in self.uris, wait_s):
                raise VoltcamError(f"nobody publishes {topic} within {wait_s:g} s: does `voltcam ros1` run?")
            return self.uris[topic]

    def close(self) -> None:
        self._server.close()

    def _register(self, caller: str, topic: str, kind: str, uri: str) -> list[str]:
        with self._changed:
            self.uris[topic] = uri
            self._changed.notify_all()
        return []


@contextlib.contextmanager
def bridge(zmq: str, wait_s: float) -> Iterator[str]:
    """`voltcam ros1` at this endpoint; gives the address of its node. Raises VoltcamError."""
    roscore = Roscore()
    here = {"ROS_MASTER_URI": roscore.uri, "ROS_HOSTNAME": "127.0.0.1", "ROS_NAMESPACE": "/"}
    command = [sys.executable, "-m", "voltcam_client.ros1", zmq]
    with (
        contextlib.closing(roscore),
        subprocess.Popen(command, env=os.environ | here, stdout=subprocess.DEVNULL) as process,
    ):
        try:
            yield roscore.publisher("/dvs/events", wait_s)
        finally:
            process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(END_S)
            process.kill()
