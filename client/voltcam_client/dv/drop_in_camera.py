"""A camera as dv-processing has it, with the names that dv-processing gives."""

import sys
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from voltcam_client.dv.biases import KNOBS, BiasControl
from voltcam_client.dv.cameras import FoundCamera

# The MPU-6500 of a DAVIS346, and pixels of 18.5 um, as iniVation's data sheet has them.
IMU_MODEL, PIXEL_PITCH_M = "IMU_INVENSENSE_6500_9250", 18.5e-6


@dataclass(frozen=True, slots=True)
class Descriptor:
    """What `discover` says of a camera, with the fields of dv-processing's DeviceDescriptor."""

    cameraModel: Any
    serialNumber: str
    deviceType: Any
    pid: int = 0
    busNumber: int = 0
    devAddress: int = 0
    firmwareVersion: int = 0


class EmulatedCamera:
    """A camera of dv-processing, on the network streams of an emulator.

    Biases are set at the daemon. What else sets something up is kept, and told on standard error; it has no
    effect.
    """

    def __init__(self, dv: ModuleType, found: FoundCamera, url: str) -> None:
        self._dv, self._found = dv, found
        self._biases = BiasControl(url, found.ports["EVTS"])
        self._readers = {kind: dv.io.NetworkReader(found.host, port) for kind, port in found.ports.items()}
        self._set: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        """What a DAVIS has beyond this: a setting, kept without effect."""
        known = not name.startswith("_") and hasattr(self._dv.io.camera.DAVIS.REAL, name)
        key = name.removeprefix("set").removeprefix("get").removeprefix("is")
        if known and name.startswith("set"):
            sys.stderr.write(f"voltcam: {name} has no effect on the emulator\n")
            return lambda *values: self._set.update({key: values[0] if len(values) == 1 else values})
        if known and name.startswith(("get", "is")) and key in self._set:
            return lambda *_: self._set[key]
        raise AttributeError(f"the emulator has no {name}")

    def getDavis346BiasCoarseFine(self, bias: Any) -> tuple[int, int]:
        if bias.name in KNOBS:
            return self._biases.get(bias)
        return tuple(self._set.get(bias.name, (0, 0)))

    def setDavis346BiasCoarseFine(self, bias: Any, coarse: int, fine: int) -> None:
        if bias.name in KNOBS:
            self._biases.set(bias, coarse, fine)
        else:
            sys.stderr.write(f"voltcam: the bias {bias.name} has no effect on the emulator\n")
            self._set[bias.name] = coarse, fine

    getDavis240BiasCoarseFine, setDavis240BiasCoarseFine = (
        getDavis346BiasCoarseFine,
        setDavis346BiasCoarseFine,
    )

    def getCameraName(self) -> str:
        return self._found.stream.source

    def getSerialNumber(self) -> str:
        return self._found.serial

    def getDeviceDescriptor(self) -> Descriptor:
        return descriptor_of(self._dv, self._found)

    def getImuModel(self) -> Any:
        models = self._dv.io.camera.imu.ImuModel
        return getattr(models, IMU_MODEL if "IMUS" in self._readers else "IMU_NONE")

    def getPixelPitch(self) -> float:
        return PIXEL_PITCH_M

    def getEventResolution(self) -> tuple[int, int] | None:
        return self._found.stream.size

    def getFrameResolution(self) -> tuple[int, int] | None:
        return self._found.stream.size if "FRME" in self._readers else None

    def isStreamAvailable(self, name: str) -> bool:
        names = {"events": "EVTS", "frames": "FRME", "triggers": "TRIG", "imu": "IMUS"}
        return names.get(name) in self._readers

    def isEventStreamAvailable(self) -> bool:
        return "EVTS" in self._readers

    def isFrameStreamAvailable(self) -> bool:
        return "FRME" in self._readers

    def isTriggerStreamAvailable(self) -> bool:
        return "TRIG" in self._readers

    def isImuStreamAvailable(self) -> bool:
        return "IMUS" in self._readers

    def isRunning(self, _name: str | None = None) -> bool:
        return all(reader.isRunning() for reader in self._readers.values())

    isConnected = isRunning

    def isRunningAny(self) -> bool:
        return any(reader.isRunning() for reader in self._readers.values())

    def isMaster(self) -> bool:
        return True

    def isSynchronized(self) -> bool:
        """The cameras of a daemon are on one clock."""
        return True

    def synchronizeWith(self, *_: Any) -> None:
        """They are."""

    def getNextEventBatch(self) -> Any:
        return self._readers["EVTS"].getNextEventBatch()

    def getNextFrame(self) -> Any:
        return self._readers["FRME"].getNextFrame() if "FRME" in self._readers else None

    def getNextTriggerBatch(self) -> Any:
        return self._readers["TRIG"].getNextTriggerBatch() if "TRIG" in self._readers else None

    def getNextImuBatch(self) -> Any:
        return self._readers["IMUS"].getNextImuBatch() if "IMUS" in self._readers else None

    def readNext(self) -> Any:
        """Whatever there is, or that there is nothing."""
        for read in (
            self.getNextEventBatch, self.getNextFrame, self.getNextTriggerBatch, self.getNextImuBatch
        ):  # fmt: skip
            if (data := read()) is not None:
                return data
        flags = self._dv.io.DataReadHandler.OutputFlag
        return flags.CONTINUE if self.isRunning() else flags.END_OF_FILE

    def config(self, compression: Any) -> Any:
        """For dv-processing's MonoCameraWriter."""
        return self._dv.io.MonoCameraWriter.DAVISConfig(
            self.getCameraName(), self.getEventResolution(), compression
        )


def descriptor_of(dv: ModuleType, found: FoundCamera) -> Descriptor:
    return Descriptor(dv.io.camera.CameraModel.DAVIS, found.serial, dv.io.camera.USBDeviceType.FX3_MB)
