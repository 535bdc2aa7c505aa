"""A roscore of twenty lines, for tests of nodes on machines without ROS 1."""

import contextlib
from collections import defaultdict
from collections.abc import Iterator

from voltcam_client.ros1 import RosError
from voltcam_client.ros1.names import Names
from voltcam_client.ros1.xml_rpc import RpcServer, call


class Master:
    """publishers, subscribers: addresses of nodes, by topic."""

    def __init__(self) -> None:
        self.publishers: dict[str, list[str]] = defaultdict(list)
        self.subscribers: dict[str, list[str]] = defaultdict(list)
        self.pid = 1
        methods = {
            "getPid": lambda caller: self.pid,
            "registerPublisher": self._register_publisher,
            "registerSubscriber": self._register_subscriber,
            "unregisterPublisher": lambda caller, topic, uri: self._update(topic, remove=uri),
            "unregisterSubscriber": lambda caller, topic, uri: self.subscribers[topic].remove(uri) or 1,
        }
        self._server = RpcServer("127.0.0.1", methods)
        self.uri = f"http://127.0.0.1:{self._server.port}/"

    def close(self) -> None:
        self._server.close()

    def names(self, node: str) -> Names:
        return Names.of(node, [], {"ROS_MASTER_URI": self.uri, "ROS_HOSTNAME": "127.0.0.1"})

    def _register_publisher(self, caller: str, topic: str, kind: str, uri: str) -> list[str]:
        self._update(topic, add=uri)
        return self.subscribers[topic]

    def _register_subscriber(self, caller: str, topic: str, kind: str, uri: str) -> list[str]:
        self.subscribers[topic].append(uri)
        return self.publishers[topic]

    def _update(self, topic: str, add: str = "", remove: str = "") -> int:
        uris = self.publishers[topic]
        uris[:] = [uri for uri in [*uris, *filter(None, [add])] if uri != remove]
        for subscriber in self.subscribers[topic]:
            with contextlib.suppress(RosError):
                call(subscriber, "publisherUpdate", "/master", topic, uris)
        return 1


@contextlib.contextmanager
def mastering() -> Iterator[Master]:
    master = Master()
    try:
        yield master
    finally:
        master.close()
