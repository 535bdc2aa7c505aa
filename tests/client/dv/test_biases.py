"""Biases by dv-processing's names, at a daemon that is asked over REST."""

from types import SimpleNamespace
from typing import Any

import pytest

from voltcam_client.control import Control
from voltcam_client.dv.biases import KNOBS, BiasControl

REFRACTORY = SimpleNamespace(name="Refractory")


class Daemon:
    """Two cameras, at DV ports 7777 and 7781."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[tuple[str, Any]] = []

        def ask(control: Control, method: str, path: str, body: Any, _: type) -> Any:
            camera = control._query.rpartition("=")[2]
            self.asked.append((f"{method} {path} {camera}", body))
            return {
                "/cameras": [{"name": "left"}, {"name": "right"}],
                "/camera": {"dv": "127.0.0.1:7777" if camera == "left" else "127.0.0.1:7781"},
                "/biases": {"RefrBp_coarse": 4, "RefrBp_fine": 25},
            }[path]

        monkeypatch.setattr(Control, "_ask", ask)


def test_the_camera_whose_streams_are_there_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    daemon = Daemon(monkeypatch)
    right = BiasControl("http://127.0.0.1:8560", 7781)
    assert right.get(REFRACTORY) == (4, 25)
    right.set(REFRACTORY, 5, 30)
    assert daemon.asked[-2:] == [
        ("GET /biases right", None),
        ("PATCH /biases right", {"RefrBp_coarse": 5, "RefrBp_fine": 30}),
    ]


def test_a_daemon_of_other_streams_is_told_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    Daemon(monkeypatch)
    with pytest.raises(RuntimeError, match="no camera at port 9999: give --url"):
        BiasControl("http://127.0.0.1:8560", 9999).get(REFRACTORY)


def test_all_names_are_dv_processing_s() -> None:
    dv = pytest.importorskip("dv_processing")
    for kind in (dv.io.camera.DAVIS.Davis346BiasCF, dv.io.camera.DAVIS.Davis240BiasCF):
        assert set(KNOBS) <= set(kind.__members__)
