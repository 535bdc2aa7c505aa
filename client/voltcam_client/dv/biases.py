"""Biases as dv-processing sets and gets them, over the REST interface of the emulator's daemon."""

from typing import Any

from voltcam_client.control import Control
from voltcam_client.errors import VoltcamError

KNOBS = {
    "Diff": "DiffBn",
    "On": "ONBn",
    "Off": "OFFBn",
    "Photoreceptor": "PrBp",
    "PhotoreceptorSourceFollower": "PrSFBp",
    "Refractory": "RefrBp",
}
"""Names of dv-processing's enumerations, and of the drivers. Others are not emulated."""


class BiasControl:
    """Of the camera whose DV streams begin at a port, at the daemon of this address."""

    def __init__(self, url: str, port: int) -> None:
        self._url, self._port = url, port
        self._control: Control | None = None

    def get(self, bias: Any) -> tuple[int, int]:
        """(coarse, fine). Raises RuntimeError, as dv-processing does, where the daemon cannot be asked."""
        try:
            now = self._camera.biases()
        except VoltcamError as error:
            raise RuntimeError(f"no bias could be read: {error}") from error
        knob = KNOBS[bias.name]
        return now[f"{knob}_coarse"], now[f"{knob}_fine"]

    def set(self, bias: Any, coarse: int, fine: int) -> None:
        """Set it. Raises RuntimeError."""
        knob = KNOBS[bias.name]
        try:
            self._camera.set_biases({f"{knob}_coarse": coarse, f"{knob}_fine": fine})
        except VoltcamError as error:
            raise RuntimeError(f"{bias.name} is not set: {error}") from error

    @property
    def _camera(self) -> Control:
        if self._control is None:
            names = [camera["name"] for camera in Control(self._url).cameras()]
            for control in (Control(self._url, camera=name) for name in names):
                if str(control.camera().get("dv") or "").endswith(f":{self._port}"):
                    self._control = control
                    return control
            raise VoltcamError(f"the daemon at {self._url} has no camera at port {self._port}: give --url")
        return self._control
