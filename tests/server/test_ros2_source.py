"""Images of a topic of ROS 2 into a whole emulator: on the publisher's clock, whatever is in the bytes."""

import itertools
import struct
import time
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("cyclonedds", reason="cyclonedds is in the extra [ros2]")
from tests.ros2 import DOMAIN, ImageWriter, own_namespace

from voltcam_client.ros2.message_types import COMPRESSED_IMAGE, IMAGE
from voltcam_client.ros2.names import Ros2Place
from voltcam_client.ros2.participant import TopicWriter, join
from voltcam_server.emulator import Emulator
from voltcam_simulator import Simulator
from voltcam_video import SourceError, SourceRequest, luminance, open_source

from .process import voltcam
from .rig import Listener, emulating, moving_frames, tiny, until

STAMPS_US = np.cumsum([0, 10_000, 3_000, 40_000, 5_000, 5_000, 20_000, 1_000, 9_000, 10_000]).tolist()
FRAMES = moving_frames(len(STAMPS_US), tiny())


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", DOMAIN)
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)


@pytest.fixture
def topic() -> str:
    return f"/{own_namespace()}/image_raw"


@pytest.fixture
def running(topic: str) -> Iterator[tuple[Emulator, Listener]]:
    with emulating(SourceRequest(uri=f"ros2:{topic}", levels="light")) as (emulator, listener):
        yield emulator, listener


Running = tuple[Emulator, Listener]


def expected(images: Any, stamps_us: list[int] = STAMPS_US) -> NDArray[np.void]:
    """The simulator alone, on the same luminance and stamps."""
    simulator = Simulator(24, 16, tiny().parameters)
    return np.concatenate([simulator.advance(image, t) for image, t in zip(images, stamps_us, strict=True)])


def hostile(topic: str, kind: str = IMAGE) -> TopicWriter:
    """A writer of whatever bytes."""
    writer = join(Ros2Place.of()).writer(topic, kind, 100)
    until(lambda: writer.readers, "the source reads")
    return writer


def cdr(t_us: int, data: bytes, big: bool = False, **changes: Any) -> bytes:
    """A message of 24 x 16 pixels in either byte order, with whatever is changed."""
    order = ">" if big else "<"
    size = {"height": 16, "width": 24, "step": 24, "count": len(data)} | changes
    body = struct.pack(f"{order}iII4s", t_us // 10**6, t_us % 10**6 * 1000, 4, b"cam\0")
    body += struct.pack(f"{order}III6s", size["height"], size["width"], 6, b"mono8\0")
    body += struct.pack(f"{order}Bx", 0)
    return (
        bytes([0, 0 if big else 1, 0, 0])
        + body
        + struct.pack(f"{order}II", size["step"], size["count"])
        + data
    )


@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_the_publisher_s_clock_alone_counts(running: Running, topic: str, reliability: str) -> None:
    emulator, listener = running
    assert emulator.source.state == "waiting"
    with ImageWriter(topic, "Image", reliability) as writer:
        for number, (frame, t_us) in enumerate(zip(FRAMES, STAMPS_US, strict=True)):
            writer.image(t_us, frame)
            listener.wait(lambda it, number=number: len(it.frames) > number)  # type: ignore[misc]
    assert [frame.t_us for frame in listener.frames] == STAMPS_US
    assert listener.events.tobytes() == expected(FRAMES).tobytes()
    assert len(listener.events) > 500
    granted = emulator.source.granted
    assert granted is not None
    assert (granted["clock"], granted["width"], granted["pixel_format"]) == ("sender", 24, "mono8")


def test_sixteen_bits_of_a_big_endian_machine_with_padded_rows(running: Running, topic: str) -> None:
    _, listener = running
    rows = np.zeros((len(FRAMES), 16, 30), ">u2")
    rows[:, :, :24] = FRAMES.astype(">u2") * 257
    with ImageWriter(topic, "Image") as writer:
        for number, (frame, t_us) in enumerate(zip(rows, STAMPS_US, strict=True)):
            writer.image(t_us, frame, "mono16", width=24, is_bigendian=1)
            listener.wait(lambda it, number=number: len(it.frames) > number)  # type: ignore[misc]
    assert listener.events.tobytes() == expected(FRAMES.astype(np.float32)).tobytes()


def test_compressed_images() -> None:
    topic = f"/{own_namespace()}/image_raw/compressed"
    files = [cv2.imencode(".jpg", np.repeat(frame[..., None], 3, 2))[1] for frame in FRAMES]
    images = [luminance(cv2.imdecode(file, cv2.IMREAD_UNCHANGED)) for file in files]
    with (
        emulating(SourceRequest(uri=f"ros2:{topic}", levels="light")) as (_, listener),
        ImageWriter(topic, "CompressedImage") as writer,
    ):
        for number, (file, t_us) in enumerate(zip(files, STAMPS_US, strict=True)):
            writer.publish(t_us, file.tobytes(), format="bgr8; jpeg compressed bgr8")
            listener.wait(lambda it, number=number: len(it.frames) > number)  # type: ignore[misc]
        assert listener.events.tobytes() == expected(images).tobytes()


def test_images_that_come_too_fast_are_counted(running: Running, topic: str) -> None:
    emulator, listener = running
    follow = emulator.simulation.follow

    def slowly(arrival: Any, *rest: Any) -> Any:
        time.sleep(0.1)
        return follow(arrival, *rest)

    emulator.simulation.follow = slowly  # type: ignore[method-assign]
    writer = hostile(topic)
    for number in range(60):
        assert writer.write(cdr(10_000 * (1 + number), FRAMES[number % 10].tobytes()))
        time.sleep(0.003)  # so that DDS itself leaves none out
    listener.wait(lambda it: it.frames and it.frames[-1].t_us == 600_000)
    frames = emulator.status.frames
    assert frames.dropped > 30
    assert frames.simulated + frames.dropped + frames.skipped <= frames.received == 60


def test_a_simulator_that_is_reset_begins_again(running: Running, topic: str) -> None:
    emulator, listener = running
    writer = hostile(topic)
    for number, t_us in enumerate((10_000, 20_000, 30_000, 5_000, 15_000)):
        writer.write(cdr(t_us, FRAMES[number].tobytes()))
        listener.wait(lambda it, number=number: len(it.frames) > number)  # type: ignore[misc]
    assert emulator.status.frames.out_of_order == 0
    assert (np.diff([frame.t_us for frame in listener.frames]) > 0).all()


def test_either_byte_order_of_a_message(running: Running, topic: str) -> None:
    _, listener = running
    writer = hostile(topic)
    for number, (frame, t_us) in enumerate(zip(FRAMES, STAMPS_US, strict=True)):
        writer.write(cdr(t_us, frame.tobytes(), big=number % 2 == 1))
        listener.wait(lambda it, number=number: len(it.frames) > number)  # type: ignore[misc]
    assert listener.events.tobytes() == expected(FRAMES).tobytes()


GOOD = FRAMES[0].tobytes()
BAD = {
    "too long": (cdr(0, GOOD) + bytes(100), "no whole sensor_msgs/Image"),
    "width too large": (cdr(0, GOOD, width=2**32 - 1), "too many"),
    "rows missing": (cdr(0, GOOD[:-24]), "360 bytes are no 16 rows of 24 bytes"),
    "step too small": (cdr(0, GOOD, step=3), "step is 3"),
    "no pixels": (cdr(0, GOOD, height=0), "24 x 0 pixels"),
    "before 1970": (cdr(-1_000_000, GOOD), "the stamp is -1 s"),
}
"""What DDS takes for an image; what is cut or counts wrong it does not even pass on."""


@pytest.mark.parametrize("name", BAD)
def test_bytes_that_are_no_image_are_said_in_one_line(running: Running, topic: str, name: str) -> None:
    emulator, listener = running
    data, words = BAD[name]
    hostile(topic).write(data)
    until(lambda: emulator.source.state == "reconnecting", "it is said")
    message = emulator.source.message
    assert words in message
    assert message.startswith(f"ros2:{topic}: ")
    assert "\n" not in message
    writer = hostile(topic)
    for number in itertools.count(1):  # it comes back by itself
        writer.write(cdr(10_000 * number, GOOD))
        time.sleep(0.02)
        if listener.frames:
            break
    assert emulator.source.state == "running"


def test_an_image_that_is_none_among_good_ones_is_counted(running: Running, topic: str) -> None:
    emulator, listener = running
    writer = hostile(topic)
    writer.write(cdr(10_000, GOOD))
    listener.wait(lambda it: it.frames)
    for data, _ in BAD.values():
        writer.write(data)
        time.sleep(0.06)  # so that none is left out for a newer one
    writer.write(cdr(20_000, GOOD))
    listener.wait(lambda it: len(it.frames) == 2)
    assert emulator.source.state == "running"
    assert emulator.status.frames.dropped == len(BAD)


def test_compressed_bytes_that_are_none() -> None:
    topic = f"/{own_namespace()}/image_raw/compressed"
    with emulating(SourceRequest(uri=f"ros2:{topic}", levels="light")) as (emulator, _):
        file = cv2.imencode(".png", FRAMES[0])[1].tobytes()[:-20]
        body = struct.pack("<iII4sI4sI", 1, 0, 4, b"cam\0", 4, b"png\0", len(file)) + file
        hostile(topic, COMPRESSED_IMAGE).write(b"\0\1\0\0" + body)
        until(lambda: emulator.source.state == "reconnecting", "it is said")
        assert "no whole png image" in emulator.source.message


@pytest.mark.parametrize("uri", ["ros2:", "ros2:a b", "ros2://x", "ros2:/a//b"])
def test_what_is_no_topic(uri: str) -> None:
    with pytest.raises(SourceError, match="is no name of ROS 2"):
        open_source(SourceRequest(uri=uri))


def test_beyond_this_machine_only_where_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    for arguments in (("--source", "ros2:/camera/image_raw"), ("--ros2", "dvs")):
        done = voltcam("serve", "--http", "127.0.0.1:0", "--zmq", "tcp://127.0.0.1:0", *arguments)
        assert done.returncode == 1
        assert "open to the network by ROS_AUTOMATIC_DISCOVERY_RANGE" in done.stderr
        assert done.stderr.count("\n") == 1
