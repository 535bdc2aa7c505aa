"""Fast DDS, which most of ROS 2 speaks, against the topics that Voltcam publishes and reads: both ways."""

import resource
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: make interop")
from tests.ros2 import DOMAIN, Peer, Reader, own_namespace, soon

from voltcam_client.encodings import ENCODINGS, EVENT
from voltcam_client.packet import TOPIC_EVENTS, FrameMessage, Packet
from voltcam_client.ros2 import messages
from voltcam_server.messages import events_message
from voltcam_server.transports import Ros2Transport
from voltcam_video import Clock, SourceRequest, SourceState, open_source, watch

SOURCES = Path(__file__).with_name("fast_dds")
BUILD_S, PATIENCE_S = 300, 60
HEADER = Path("/usr/include/fastdds/dds/topic/TypeSupport.hpp")


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program of fast_dds/, built."""
    if not (HEADER.exists() and shutil.which("fastddsgen") and shutil.which("g++")):
        pytest.skip("Fast DDS is not installed: apt install libfastrtps-dev fastddsgen g++")
    folder = tmp_path_factory.mktemp("fast_dds")
    for file in SOURCES.iterdir():
        shutil.copy(file, folder)
    sources = ["peer.cpp", "messages.cxx", "messagesPubSubTypes.cxx"]
    for command in (
        ["fastddsgen", "-replace", "messages.idl"],
        ["g++", "-std=c++14", "-o", "peer", *sources, "-lfastrtps", "-lfastcdr"],
    ):
        subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=BUILD_S)
    return folder / "peer"


@pytest.fixture(autouse=True, params=["LOCALHOST", "SUBNET"])
def reach(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Fast DDS has its defaults, as ROS 2 has them, whatever Voltcam is told. The domains are two, since one
    process has one way to be in a domain."""
    domain = str(int(DOMAIN) + (request.param == "SUBNET"))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", request.param)
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    monkeypatch.setattr("tests.ros2.DOMAIN", domain)


@pytest.mark.parametrize("encoding", ["libcaer", "evt3"])
def test_fast_dds_reads_every_event(peer: Path, encoding: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    transport = Ros2Transport(own_namespace(), encoding, {TOPIC_EVENTS: 65536})
    packets = []
    for seq in range(100):
        events = np.zeros(int(rng.integers(0, 5000)), EVENT)
        events["t"] = 1_700_000_000_000_000 + 1000 * seq + np.sort(rng.integers(0, 1000, events.size))
        events["x"], events["y"] = rng.integers(0, 346, events.size), rng.integers(0, 260, events.size)
        events["p"] = rng.integers(0, 2, events.size)
        base_ns = 1000 * (1_700_000_000_000_000 + 1000 * seq)
        packets.append(
            Packet(events=events, width=346, height=260, seq=seq, time_base_ns=base_ns, stamp_ns=1)
        )
    topic = f"{transport.namespace}/events"
    program = (str(peer),)
    with Reader(topic, "EventPacket", len(packets), tmp_path / "out", program=program) as reader:
        transport.start()
        assert reader.says() == "found"
        assert soon(lambda: transport._topics[TOPIC_EVENTS][0][0].readers == 1)
        for packet in packets:
            transport.publish(events_message(packet))
        came = reader.messages()
    transport.stop()
    assert [message["seq_"] for message in came] == list(range(len(packets)))
    for message, packet in zip(came, packets, strict=True):
        decode = ENCODINGS[message["encoding_"]].decode
        events = decode(bytes.fromhex(message["events_"]), message["time_base_"] // 1000)
        np.testing.assert_array_equal(events, packet.events)
        assert message["header_"]["frame_id_"] == packet.frame_id


def test_images_of_fast_dds_are_read(peer: Path) -> None:
    """From the first that comes on: a writer knows of its reader a little before the reader knows of it."""
    topic, stop = f"/{own_namespace()}/image_raw", threading.Event()
    limit = threading.Timer(PATIENCE_S, stop.set)
    came: list[int] = []
    with (
        open_source(SourceRequest(uri=f"ros2:{topic}"), Clock(), stop) as source,
        Peer(peer, f"rt{topic}", "Image", "10", "-") as writer,
    ):

        def read() -> None:
            while (frame := source.read()) is not None:
                number = (frame.t_us - 1_000_000) // 10_000
                np.testing.assert_array_equal(frame.image, np.full((16, 24), 10 * number))
                came.append(number)

        reading = threading.Thread(target=read)
        reading.start()
        limit.start()
        assert writer.says() == "found"
        assert writer.process.stdin is not None
        for number in range(10):
            writer.process.stdin.write("next\n")
            writer.process.stdin.flush()
            assert writer.says() == "one"
            soon(lambda number=number: number in came, 2.0)  # type: ignore[misc]
        stop.set()
        reading.join(PATIENCE_S)
        limit.cancel()
    assert came == list(range(came[0] if came else 0, 10))
    assert len(came) > 5


def hostile(rng: np.random.Generator) -> list[bytes]:
    """A good image's bytes cut at every length, longer, with other numbers in them; and bytes of chance."""
    good = messages.image(FrameMessage(image=np.full((16, 24), 50, np.uint8), t_us=1, seq=0, stamp_ns=1))
    made = [good[:size] for size in range(4, len(good), 7)]
    made += [good + bytes(more) for more in (1, 4, 100, 60_000)]
    for _ in range(200):
        changed = bytearray(good)
        for at in rng.integers(4, 60, 3):
            changed[at] = rng.integers(0, 256)
        made.append(bytes(changed))
    return made + [b"\0\1\0\0" + rng.bytes(int(size)) for size in rng.integers(1, 2000, 100)]


def test_hostile_bytes_of_a_foreign_writer_leave_the_source_well(peer: Path) -> None:
    topic = f"/{own_namespace()}/image_raw"
    stop, came = threading.Event(), []
    good = messages.image(FrameMessage(image=np.full((16, 24), 50, np.uint8), t_us=10**9, seq=0, stamp_ns=1))
    bad = hostile(np.random.default_rng(1))

    def read() -> None:
        states: list[SourceState] = []
        for frame in watch(SourceRequest(uri=f"ros2:{topic}"), stop, states.append):
            came.append(frame)
        assert all("\n" not in state.message for state in states)

    thread = threading.Thread(target=read)
    thread.start()
    try:
        with Peer(peer, f"rt{topic}", "Raw", str(len(bad) + 10_000), "-") as writer:
            assert writer.says() == "found"
            assert writer.process.stdin is not None
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

            def write(data: bytes) -> None:
                assert writer.process.stdin is not None
                writer.process.stdin.write(data.hex() + "\n")
                writer.process.stdin.flush()
                assert writer.says() == "one"

            for data in bad:
                write(data)

            def well() -> bool:
                write(good)
                return any(frame.t_us == 10**9 for frame in came)

            assert soon(well)
            assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # KiB
    finally:
        stop.set()
        thread.join(20)
    assert not thread.is_alive()
