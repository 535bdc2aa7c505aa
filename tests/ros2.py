"""Programs of DDS beside a test, in processes of their own: set up as docs/how-to/ros-2.md says."""

import json
import os
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Self

from numpy.typing import NDArray

PEERS = Path(__file__).parent / "ros2_peers"
DOMAIN = "47"
PATIENCE_S = 60.0
LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>100</MaxAutoParticipantIndex><Peers><Peer address='localhost'/></Peers>"
    "</Discovery></Domain></CycloneDDS>"
)


def own_namespace() -> str:
    """Of topics that no other test, in this process or another, has."""
    return f"dvs_{uuid.uuid4().hex[:12]}"


def soon(condition: Callable[[], bool], wait_s: float = PATIENCE_S) -> bool:
    """Whether it comes to hold."""
    deadline_s = time.monotonic() + wait_s
    while not condition() and time.monotonic() < deadline_s:
        time.sleep(0.01)
    return condition()


class Peer:
    """A program that says a word when it is ready; a context manager that ends it."""

    def __init__(self, *command: str | Path) -> None:
        environment = os.environ | {"CYCLONEDDS_URI": LOOPBACK, "ROS_DOMAIN_ID": DOMAIN}
        self.process = subprocess.Popen(
            [str(each) for each in command],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._too_late = threading.Timer(PATIENCE_S, self.process.kill)
        self._too_late.start()

    def says(self) -> str:
        """Its next line."""
        assert self.process.stdout is not None
        return self.process.stdout.readline().strip()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._too_late.cancel()
        self.process.kill()
        self.process.communicate()


class Reader(Peer):
    """Reads so many messages of a topic, by Cyclone's own deserialiser or another program's."""

    def __init__(
        self, topic: str, kind: str, count: int, file: Path, *options: str, program: Sequence[str] = ()
    ) -> None:
        program = program or (sys.executable, str(PEERS / "reader.py"))
        super().__init__(*program, f"rt{topic}", kind, str(count), file, *options)
        self._file = file

    def messages(self) -> list[dict[str, Any]]:
        """All that came, when the program has ended."""
        self.process.communicate(timeout=PATIENCE_S)
        return [json.loads(line) for line in self._file.read_text().splitlines()]


class ImageWriter(Peer):
    """Publishes images by Cyclone's own serialiser; made when a reader was found."""

    def __init__(self, topic: str, kind: str, *options: str) -> None:
        super().__init__(sys.executable, PEERS / "writer.py", f"rt{topic}", kind, *options)
        assert self.says() == "found"

    def publish(self, t_us: int, data: bytes, **fields: Any) -> None:
        named = {f"{name}_": value for name, value in (fields | {"data": data.hex()}).items()}
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps([t_us, named]) + "\n")
        self.process.stdin.flush()
        assert self.says() == "one"

    def image(self, t_us: int, image: NDArray[Any], encoding: str = "mono8", **fields: Any) -> None:
        height, width = image.shape[:2]
        size = {"height": height, "width": width, "step": image.strides[0], "encoding": encoding}
        self.publish(t_us, image.tobytes(), **{"is_bigendian": 0} | size | fields)
