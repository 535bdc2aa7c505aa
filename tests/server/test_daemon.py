"""`voltcam serve` as a user has it: a process, its ports, its signals; measured in the packets received."""

import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import numpy as np
import pytest
import yaml
import zmq
from websockets.sync.client import connect

from voltcam_client import Control, ControlError, EventCamera
from voltcam_client.formats import read
from voltcam_client.packet import Packet, decode_message
from voltcam_simulator.effects.junction_leak import arrhenius

from .process import Daemon, voltcam_path
from .rig import PATIENCE_S, save_frames, until

WIDTH, HEIGHT = 64, 48
README = Path(__file__).parents[2] / "README.md"


def camera_file(folder: Path, **parameters: object) -> str:
    path = folder / "camera.yaml"
    path.write_text(yaml.safe_dump({"name": "small", "width": WIDTH, "height": HEIGHT, **parameters}))
    return str(path)


def collect(endpoint: str, span_s: float, change: Callable[[], object] | None = None) -> list[Packet]:
    """Packets over `span_s` of the events' clock; then, after `change`, as much under the next version of the
    parameters. They are sorted, in bounds, gap-free and on one time line."""
    packets: list[Packet] = []
    begin_ns, version, done = 0, -1, False
    deadline_s = time.monotonic() + PATIENCE_S
    with EventCamera(endpoint, timeout_s=PATIENCE_S) as camera:
        for packet in camera:
            assert time.monotonic() < deadline_s
            packets.append(packet)
            if packet.parameters_version != version:
                begin_ns, version, done = packet.time_base_ns, packet.parameters_version, False
            if not done and packet.time_base_ns - begin_ns > span_s * 1e9:
                if change is None:
                    break
                change()
                change, done = None, True  # what comes of this version now is more of the same
    assert np.diff([packet.seq for packet in packets]).tolist() == [1] * (len(packets) - 1)
    events = np.concatenate([packet.events for packet in packets])
    assert (np.diff(events["t"]) >= 0).all()
    assert (events["x"] < packets[0].width).all()
    assert (events["y"] < packets[0].height).all()
    return packets


def rate_per_s(packets: list[Packet], version: int) -> tuple[float, int]:
    """Events per second of the events' clock under one version of the parameters, and how many there were."""
    mine = [packet for packet in packets if packet.parameters_version == version]
    begin_us, end_us = mine[0].time_base_ns // 1000, mine[-1].time_base_ns // 1000
    t = np.concatenate([packet.events["t"] for packet in mine])
    count = int(((t >= begin_us) & (t < end_us)).sum())
    return count / (end_us - begin_us) * 1e6, count


@pytest.fixture(scope="module")
def daemon() -> Iterator[Daemon]:
    """The built-in scene, seen by all tests that leave it as it is."""
    with Daemon("--encoding", "evt3") as daemon:
        yield daemon


def test_the_readme_s_ten_lines_get_sound_packets(daemon: Daemon) -> None:
    program = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)[0]
    assert "tcp://127.0.0.1:5560" in program
    done = subprocess.run(
        [sys.executable, "-c", program.replace("tcp://127.0.0.1:5560", daemon.zmq)],
        capture_output=True, text=True, timeout=PATIENCE_S, check=False,
    )  # fmt: skip
    assert done.stderr == ""
    *packets, lost = done.stdout.splitlines()
    assert lost == "0 packets lost"
    seq, sizes = np.array([line.split() for line in packets], int).T
    assert (np.diff(seq) == 1).all()
    assert sizes.sum() > 1000


def test_the_rate_fits_the_scene(daemon: Daemon) -> None:
    """Its texture drifts by a pixel and a half per frame: every pixel fires some times per second."""
    packets = collect(daemon.zmq, 1.0)
    assert 3 < rate_per_s(packets, 0)[0] / (346 * 260) < 100


def test_zeromq_and_websocket_give_the_same_events(daemon: Daemon) -> None:
    url = daemon.url.replace("http", "ws") + "api/v1/events?encoding=mono"
    with connect(url, close_timeout=0.1) as socket, EventCamera(daemon.zmq, timeout_s=PATIENCE_S) as camera:
        by_zmq = {packet.seq: packet for packet, _ in zip(camera, range(300), strict=False)}
        by_websocket: dict[int, Packet] = {}
        while max(by_websocket, default=0) < max(by_zmq):
            message = socket.recv(timeout=PATIENCE_S)
            assert isinstance(message, bytes)
            packet = decode_message(message)
            by_websocket[packet.seq] = packet
    same = by_zmq.keys() & by_websocket.keys()
    assert len(same) > 200
    for seq in same:
        assert (by_zmq[seq].encoding, by_websocket[seq].encoding) == ("evt3", "mono")
        np.testing.assert_array_equal(by_zmq[seq].events, by_websocket[seq].events)


def test_the_page_is_there(daemon: Daemon) -> None:
    page = httpx.get(daemon.url, trust_env=False)
    assert page.headers["content-type"].startswith("text/html")
    assert "Voltcam" in page.text


def test_the_switch_is_exact_and_an_invalid_change_is_none() -> None:
    with Daemon("--camera", "paper") as daemon:
        control = Control(daemon.url)
        before = control.parameters()
        with pytest.raises(ControlError, match=r"comparator\.theta_off: Input should be greater"):
            control.set({"comparator": {"theta_on": 2, "theta_off": 0}})
        assert control.parameters() == before
        keys = ["contrast_response.k1", "photon_noise.k3", "junction_leak.k4_per_us"]
        keys += ["parasitic_photocurrent.k5_per_dn_us", "leak_noise.k6"]
        packets = collect(daemon.zmq, 0.3, lambda: control.set(dict.fromkeys(keys, 0)))
    versions = [packet.parameters_version for packet in packets]
    assert versions == sorted(versions)
    assert set(versions) == {0, 1}
    assert all(packet.events.size == 0 for packet in packets if packet.parameters_version == 1)
    assert sum(packet.events.size for packet in packets) > 1000


def test_ten_degrees_multiply_the_leak_by_arrhenius(tmp_path: Path) -> None:
    """Leak alone, at rest: 64 x 48 pixels at 100 Hz each. Intervals are more regular than Poisson's, so that
    with counts N1, N2 the ratio is off by more than 5 sqrt(1/N1 + 1/N2) in less than one of 1.7 million runs.
    As fast as the simulation goes, no interval is skipped: its events would be missing.
    """
    still = save_frames(tmp_path / "still.npz", np.full((1500, HEIGHT, WIDTH), 128, np.uint8), 20_000)
    leak = {"junction_leak": {"k4_per_us": 1e-4}, "parasitic_photocurrent": {"k5_per_dn_us": 0}}
    with Daemon("--source", still, "--loop", "--fast", "--camera", camera_file(tmp_path, **leak)) as daemon:
        control = Control(daemon.url)
        packets = collect(daemon.zmq, 0.7, lambda: control.set({"temperature_c": 35}))
        (before, n1), (after, n2) = (rate_per_s(packets, version) for version in (0, 1))
        expected = arrhenius(35, 0.56) / arrhenius(25, 0.56)
        tolerance = 5 * np.sqrt(1 / n1 + 1 / n2)
        assert tolerance < 0.02
        assert after / before == pytest.approx(expected, rel=tolerance)
        assert before == pytest.approx(WIDTH * HEIGHT * 100, rel=5 / np.sqrt(n1))


def test_doubled_thresholds_halve_the_rate(tmp_path: Path) -> None:
    """Brightness goes up and down between 20 and 220 with a gain of 50 thresholds per e-fold: 90 events per
    way, of which a turn costs half an event at either threshold: 0.6 % of the ratio. How much of the first
    and last of 8 ways or more falls into the 2 s or more is within the 6 % allowed. As fast as the simulation
    goes, no frame is dropped: a turn would be lost with it."""
    up = np.linspace(20, 220, 26)
    levels = np.concatenate([up, up[-2:0:-1]]).astype(np.uint8)
    frames = np.ones((len(levels), HEIGHT, WIDTH), np.uint8) * levels[:, None, None]
    source = save_frames(tmp_path / "waves.npz", frames, 10_000)
    file = camera_file(tmp_path, contrast_response={"k1": 50})
    with Daemon("--source", source, "--loop", "--fast", "--camera", file) as daemon:
        control = Control(daemon.url)
        doubled = {"comparator": {"theta_on": 2, "theta_off": 2}}
        packets = collect(daemon.zmq, 2.0, lambda: control.set(doubled))
    ratio = rate_per_s(packets, 1)[0] / rate_per_s(packets, 0)[0]
    assert ratio == pytest.approx(0.5, rel=0.06)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_at_once_and_keep_the_recording(tmp_path: Path, number: int) -> None:
    path = tmp_path / "out.npz"
    daemon = Daemon("--record", str(path))
    url = daemon.url.replace("http", "ws") + "api/v1/events"
    # Subscribers that have stopped reading are no reason to wait.
    with (
        connect(url, close_timeout=0.1) as socket,
        zmq.Context() as context,
        context.socket(zmq.SUB) as other,
    ):
        other.connect(daemon.zmq)
        other.subscribe(b"")
        other.recv_multipart()
        socket.recv(timeout=PATIENCE_S)
        until(lambda: daemon.get("status")["recording"]["frames"] > 3, "frames are recorded")
        daemon.http.close()
        code, errors, took_s = daemon.end(number)
    assert (code, errors) == (0, "")
    assert took_s < 8  # two on a machine that has nothing else to do, and the .npz put together
    assert read(path).frames is not None
    assert read(path).events.size > 0


def test_a_signal_ends_it_while_it_waits_for_its_source() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        uri = f"http://127.0.0.1:{silent.getsockname()[1]}/"
        command = [
            voltcam_path(),
            "serve",
            "--http",
            "127.0.0.1:0",
            "--zmq",
            "tcp://127.0.0.1:0",
            "--source",
            uri,
        ]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        silent.settimeout(PATIENCE_S)
        connection, _ = silent.accept()
        process.send_signal(signal.SIGINT)
        errors = process.communicate(timeout=PATIENCE_S)[1]
        connection.close()
    assert (process.returncode, errors) == (130, "")
