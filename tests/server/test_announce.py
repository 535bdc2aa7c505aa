"""Found by another program's multicast DNS, and gone again."""

import socket
import threading
from pathlib import Path

import pytest
from zeroconf import IPVersion, ServiceBrowser, ServiceStateChange, Zeroconf

from voltcam_server.announce import KIND

from .process import Daemon
from .rig import PATIENCE_S

LOOPBACK = "127.0.0.1"


def test_a_camera_is_found_and_gone_again(tmp_path: Path) -> None:
    config = tmp_path / "voltcam.yaml"
    config.write_text("{announce: true, camera: paper}")
    name = f"paper on {socket.gethostname()}.{KIND}"
    there, gone = threading.Event(), threading.Event()

    def on_change(zeroconf: Zeroconf, service_type: str, name: str, state_change: ServiceStateChange) -> None:
        (gone if state_change is ServiceStateChange.Removed else there).set()

    with Zeroconf(interfaces=[LOOPBACK]) as network:
        browser = ServiceBrowser(network, KIND, handlers=[on_change])
        with Daemon("--config", str(config)) as daemon:
            assert there.wait(PATIENCE_S)
            found = network.get_service_info(KIND, name, int(1000 * PATIENCE_S))
            assert found is not None
            assert found.parsed_addresses(IPVersion.V4Only) == [LOOPBACK]
            assert f":{found.port}/" in daemon.url
            properties = {key.decode(): (value or b"").decode() for key, value in found.properties.items()}
            assert (properties["camera"], properties["https"]) == ("paper", "0")
            assert daemon.zmq.endswith(f":{properties['zmq']}")
        assert gone.wait(PATIENCE_S)
        browser.cancel()


def test_nobody_is_told_unless_it_is_asked_for() -> None:
    with Zeroconf(interfaces=[LOOPBACK]) as network, Daemon():
        assert network.get_service_info(KIND, f"davis346 on {socket.gethostname()}.{KIND}", 1500) is None


def test_without_the_extra_the_remedy_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    from voltcam_server import announce
    from voltcam_server.problems import UsageError

    monkeypatch.setitem(__import__("sys").modules, "zeroconf", None)
    with (
        socket.create_server((LOOPBACK, 0)) as listener,
        pytest.raises(UsageError, match=r"pip install 'voltcam\[announce\]'"),
        announce.announced(listener, False, {}),
    ):
        pass
