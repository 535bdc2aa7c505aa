"""dv-processing with the emulator in place of its cameras: `install` it, then run a program as it is.

What opens or finds a camera answers with the DV streams of running daemons: `dv.io.camera.open`, `openSync`,
`discover`, `DAVIS`; and, for programs of dv-processing 1.7, `dv.io.CameraCapture` and `discoverDevices`.
Readers, files and algorithms are dv-processing's own.
"""

from collections.abc import Sequence
from types import ModuleType
from typing import Any

from voltcam_client.dv.cameras import FoundCamera, find
from voltcam_client.dv.drop_in_camera import Descriptor, EmulatedCamera, descriptor_of
from voltcam_client.errors import VoltcamError

# What the arguments are called that say which camera.
WHICH = ("serialNumber", "descriptor", "filterBySerialNumber", "deviceToOpen", "cameraName")


def install(dv: ModuleType, addresses: Sequence[str], url: str) -> None:
    """Have dv-processing find the cameras at these addresses, and no others. url: their daemon's, for biases.

    Raises VoltcamError where there are none.
    """

    def cameras() -> list[FoundCamera]:
        return [found for address in addresses for found in find(address)]

    def discover() -> list[Descriptor]:
        return [descriptor_of(dv, found) for found in cameras()]

    def open_camera(which: Any = None, *_: Any, **named: Any) -> EmulatedCamera:
        """By serial number, by name, by descriptor, or the first."""
        which = next((named[name] for name in WHICH if name in named), which)
        wanted = getattr(which, "serialNumber", which)
        found = cameras()
        for each in found:
            if not isinstance(wanted, str) or wanted in ("", each.serial, each.stream.source):
                return EmulatedCamera(dv, each, url)
        names = ", ".join(each.stream.source for each in found) or "none"
        raise RuntimeError(f"there is no camera {wanted or ''} at {', '.join(addresses)}, only {names}")

    if not cameras():
        raise VoltcamError(
            f"no DV streams at {', '.join(addresses)}: start `voltcam serve`, or give --dv HOST:PORT"
        )
    _replace_davis(dv, open_camera)
    dv.io.camera.open = dv.io.camera.openSync = dv.io.CameraCapture = open_camera
    dv.io.camera.discover = discover
    dv.io.discoverDevices = lambda *_: [found.stream.source for found in cameras()]
    _let_writers_take_cameras(dv)


def _replace_davis(dv: ModuleType, open_camera: Any) -> None:
    """`DAVIS(...)` opens the emulator; its enumerations are the real one's. Cameras are instances of it."""
    real = dv.io.camera.DAVIS

    class Kind(type):
        REAL = real

        def __call__(cls, *given: Any, **options: Any) -> Any:
            return open_camera(*given, **options)

        def __instancecheck__(cls, instance: Any) -> bool:
            return isinstance(instance, (EmulatedCamera, real))

        def __getattr__(cls, name: str) -> Any:
            return getattr(real, name)

    dv.io.camera.DAVIS = Kind("DAVIS", (), {})


def _let_writers_take_cameras(dv: ModuleType) -> None:
    """MonoCameraWriter(path, camera), and its CaptureConfig(camera)."""
    real = dv.io.MonoCameraWriter
    lz4 = dv.CompressionType.LZ4

    class MonoCameraWriter(real):  # type: ignore[misc, valid-type]
        def __init__(self, path: Any, source: Any, compression: Any = lz4) -> None:
            if isinstance(source, EmulatedCamera):
                super().__init__(path, source.config(compression))
            else:
                super().__init__(path, source)

        @staticmethod
        def CaptureConfig(capture: Any, compression: Any = lz4) -> Any:
            return capture.config(compression)

    dv.io.MonoCameraWriter = MonoCameraWriter
