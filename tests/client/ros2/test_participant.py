"""Writers and readers of packed CDR: what is wanted, what is taken, who matches whom."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="cyclonedds is in the extra [ros2]")
from tests.ros2 import DOMAIN, ImageWriter, own_namespace, soon

from voltcam_client.packet import FrameMessage
from voltcam_client.ros2 import Ros2Error, messages
from voltcam_client.ros2.message_types import IMAGE
from voltcam_client.ros2.names import Ros2Place
from voltcam_client.ros2.participant import READER_MESSAGES, Participant, TopicReader, join

PLACE = Ros2Place(int(DOMAIN))


def cdr(number: int = 0) -> bytes:
    """An image; its bytes are a multiple of four, to which Cyclone pads."""
    image = np.full((4, 6), number, np.uint8)
    return messages.image(FrameMessage(image=image, t_us=number, seq=0, stamp_ns=1))


def taken(reader: TopicReader, count: int) -> list[bytes]:
    got: list[bytes] = []

    def all_are_there() -> bool:
        got.extend(reader.take(0.1))
        return len(got) >= count

    assert soon(all_are_there)
    return got


def test_what_is_written_is_read_once_somebody_wants_it() -> None:
    topic = f"/{own_namespace()}/image_raw"
    writer = join(PLACE).writer(topic, IMAGE, 10)
    assert writer.readers == 0
    reader = join(PLACE).reader(topic, IMAGE)
    assert soon(lambda: writer.readers == 1)
    assert writer.write(cdr())
    assert taken(reader, 1) == [cdr()]
    assert reader.take(0.01) == []
    del reader
    assert soon(lambda: writer.readers == 0)


def test_a_reader_keeps_the_newest() -> None:
    topic = f"/{own_namespace()}/image_raw"
    reader, writer = join(PLACE).reader(topic, IMAGE), join(PLACE).writer(topic, IMAGE, 10)
    assert soon(lambda: writer.readers == 1)
    sent = [cdr(number) for number in range(40)]
    for message in sent:
        writer.write(message)
    assert taken(reader, READER_MESSAGES) == sent[-READER_MESSAGES:]


@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_writers_of_either_kind_are_heard(reliability: str) -> None:
    topic = f"/{own_namespace()}/image_raw"
    reader = join(PLACE).reader(topic, IMAGE)
    found: list[bytes] = []
    over = threading.Event()

    def read() -> None:  # meanwhile: a writer is made when it has a reader that matches
        while not over.is_set():
            found.extend(reader.take(0.05))

    thread = threading.Thread(target=read)
    thread.start()
    try:
        with ImageWriter(topic, "Image", reliability) as writer:
            fields = {"height": 1, "width": 1, "step": 1, "encoding": "mono8", "is_bigendian": 0}

            def heard() -> bool:
                writer.publish(1, b"\x07", **fields)
                return bool(found)

            assert soon(heard)
    finally:
        over.set()
        thread.join(10)
    assert found[0][-4:].rstrip(b"\0").endswith(b"\x07")


def test_one_process_is_in_a_domain_once() -> None:
    assert join(PLACE) is join(PLACE)
    with pytest.raises(Ros2Error, match=f"domain {DOMAIN} cannot be joined"):
        Participant(PLACE)


def test_it_leaves_no_file_and_says_nothing(tmp_path: Path) -> None:
    program = (
        "from voltcam_client.ros2.names import Ros2Place\nfrom voltcam_client.ros2.participant import join\n"
        f"join(Ros2Place({DOMAIN})).writer('/nobody', 'sensor_msgs/Image', 1).write({cdr()!r})"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=os.environ,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert not list(tmp_path.iterdir())
