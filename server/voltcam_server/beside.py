"""What a DAVIS gives beside its events, on their clock: APS frames, IMU samples, triggers."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from voltcam_client.samples import IMU, TRIGGER, TRIGGER_KINDS, ImuSamples, Triggers
from voltcam_simulator import ApsFrame, ApsFrames, Camera, ImuAtRest, Parameters
from voltcam_video import Image

NS_PER_US = 1000
Frames = Literal["source", "aps", "off"]


class DavisSettings(BaseModel):
    """What a camera gives beside its events."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    frames: Frames = Field(
        default="source",
        description="source: each frame of the source; aps: those of a DAVIS, exposed and read out at the "
        "times of the effect aps_coupling; off: none",
    )
    imu_hz: float = Field(
        default=0, ge=0, le=8000, description="samples per second of an IMU at rest; 0: there is none"
    )
    triggers_hz: float = Field(
        default=0,
        ge=0,
        le=1000,
        description="periods per second of a square wave at the trigger input, a trigger for each edge; with "
        "APS frames, triggers for these, too; 0: no triggers",
    )


class Beside(NamedTuple):
    """Of an interval, each in order of time."""

    frames: tuple[ApsFrame, ...] = ()
    imu: ImuSamples = np.empty(0, IMU)
    triggers: Triggers = np.empty(0, TRIGGER)

    def cut(self, t_us: int) -> tuple["Beside", "Beside"]:
        """What is before t_us, and the rest; a frame is there when its exposure has ended."""
        if not (self.frames or self.imu.size or self.triggers.size):
            return self, self  # a thousand times a second
        frames = sum(frame.exposure_us[1] < t_us for frame in self.frames)
        imu = int(np.searchsorted(self.imu["t"], t_us))
        triggers = int(np.searchsorted(self.triggers["t"], t_us))
        return (
            Beside(self.frames[:frames], self.imu[:imu], self.triggers[:triggers]),
            Beside(self.frames[frames:], self.imu[imu:], self.triggers[triggers:]),
        )


NOTHING = Beside()


class BesideEvents:
    """Of one camera, from its source's frames: the simulation asks for it with each of them."""

    def __init__(self, camera: Camera, seed: int, settings: DavisSettings) -> None:
        self._settings = settings
        self._height = camera.height
        self._aps = ApsFrames(camera.height) if settings.frames == "aps" else None
        self._imu = ImuAtRest(settings.imu_hz, seed) if settings.imu_hz else None
        self._last_us: int | None = None

    def until(self, image: Image, t_us: int, parameters: Parameters, *, jumped: bool) -> Beside:
        """What is after the last frame and up to this one. jumped: this one does not follow from that."""
        last_us, self._last_us = self._last_us, t_us
        frames: list[ApsFrame] = []
        light = image if self._aps is None else parameters.input_response.light_of(image)
        if self._aps is not None and jumped:
            self._aps.jump(light, t_us)
        elif self._aps is not None:
            frames = self._aps.advance(parameters.aps_coupling, light, t_us)
        if last_us is None or t_us <= last_us:
            return Beside(tuple(frames))
        return Beside(
            tuple(frames),
            self._samples(last_us, t_us, parameters.temperature_c),
            self._triggers(last_us, t_us, parameters),
        )

    def _samples(self, begin_us: int, end_us: int, temperature_c: float) -> ImuSamples:
        if self._imu is None:
            return np.empty(0, IMU)
        theirs = self._imu.samples(begin_us, end_us, temperature_c)
        samples = np.empty(theirs.t_us.size, IMU)
        for name, column in zip(("t", "temperature_c", "accel_g", "gyro_deg_s"), theirs, strict=True):
            samples[name] = column
        return samples

    def _triggers(self, begin_us: int, end_us: int, parameters: Parameters) -> Triggers:
        if not self._settings.triggers_hz:
            return np.empty(0, TRIGGER)
        period_ns = round(1e9 / self._settings.triggers_hz)
        marks = [("rising edge", 0, period_ns), ("falling edge", period_ns // 2, period_ns)]
        if self._aps is not None:
            times = parameters.aps_coupling.times(self._height)
            marks += [
                (kind, times.begin_ns + after_ns, times.period_ns)
                for kind, after_ns in (
                    ("frame begins", 0),
                    ("exposure begins", times.exposed_ns),
                    ("exposure ends", times.read_ns),
                    ("frame ends", times.end_ns),
                )
            ]
        parts = [
            _marks(TRIGGER_KINDS[kind], first_ns, period_ns, begin_us, end_us)
            for kind, first_ns, period_ns in marks
        ]
        triggers = np.concatenate(parts)
        return triggers[np.argsort(triggers["t"], kind="stable")]


def _marks(kind: int, first_ns: int, period_ns: int, begin_us: int, end_us: int) -> Triggers:
    """A trigger each period, those with begin_us < t <= end_us; t is rounded down."""
    low, high = ((t_us + 1) * NS_PER_US - first_ns for t_us in (begin_us, end_us))
    number = np.arange(-(-low // period_ns), -(-high // period_ns))
    triggers = np.empty(number.size, TRIGGER)
    triggers["t"], triggers["kind"] = (first_ns + number * period_ns) // NS_PER_US, kind
    return triggers
