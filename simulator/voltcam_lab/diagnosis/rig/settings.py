"""The numbers by which a recording is made ready and cameras are simulated on its light.

They are part of the settings of a search (`search/settings.py`), and have its sources. They are here because
a session and its rig come before any search.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class RecordingSettings:
    """What of a recording is looked at, and which recordings are refused."""

    seconds: float = 10.0
    """Length of what is looked at, from where events begin [s]. Convention: time."""
    most_samples: int = 3_500_000
    """Pixels times frames, of more only strips. Convention: 60 x 60 pixels for 10 s at 100 frames/s."""
    most_events: int = 100_000
    """Events, of more only strips. Convention: time."""
    most_steps: int = 15_000_000
    """Pixels times steps that effects of the camera file ask the simulator for. Convention: time."""
    whole_share: float = 0.2
    """Share of the events that strips may have, from which all are looked at instead. Convention: time. Of a
    few dead pixels strips may have none, and some effects act across all columns."""
    most_whole_samples: int = 12_000_000
    """Pixels times frames of the whole sensor; of more only its beginning. Convention: half a GB of light."""
    narrowest_strip: int = 6
    """Columns of each of the two strips, at least. Convention: neighbours within."""
    compared_frames: int = 50
    """Frames, about so many, that tell where light changes. Convention: time."""
    longest_silence_us: int = 100_000
    """Time without events at an end of a recording: longer, it is none of the camera's. Convention."""
    fewest_frames: int = 10
    """Frames, else a recording is refused. Convention."""
    fewest_events: int = 50
    """Events where light is known, else a recording is refused. Convention."""
    longest_wait_us: int = 100_000
    """Lateness of all events by which they may queue before a slow readout. Longer, it is another clock.
    Convention."""
    noisy_dn2: float = 0.15
    """Variance of what is in one frame only, above which frames are calmed [DN^2]. Convention: nearly twice
    the 1/12 of rounding."""


@dataclass(frozen=True)
class LightError:
    """Scale of the light's error half way between two frames, which has Student's law: the root of the sum of
    squares of two parts.

    of_surprise: share of the largest `Scene.surprise` there. of_change: share of the surprise that such a
    change from frame to frame makes in this scene (`Scene.surprise_by_change`), times its `fall`.
    """

    of_surprise: float
    of_change: float


@dataclass(frozen=True)
class RigSettings:
    """Light, and time before and after a recording, in simulated runs."""

    versions: int = 4
    """Versions of the light; a power of two of them. What frames leave open must not look like a
    gap. Convention: time."""
    on_curves: LightError = LightError(0.05, 1.5)
    """The light's error where it lies on a curve through the frames. Measured on the generator's development
    scenes: 0.03 to 0.06 of six of 200 frames/s, and 0.7 to 3.6 of 30 of 26 to 200 frames/s."""
    along_motion: LightError = LightError(0.1, 0.65)
    """The same where motion had to be guessed. Measured: 0.07 to 0.29 and 0.33 to 1.1 on 16 scenes of 27 to
    136 frames/s."""
    noisier: float = 1.5
    """Times its errors, at frames and between them: a light that is noisier than was told. Measured: a scale
    of 0.09 to 0.23 half way between frames in 22 scenes, a factor of 1.5 to either side."""
    lead_in_us: int = 500_000
    """Time for which a camera has seen the scene before it records, see `run_up`. Convention."""
    lead_out_us: int = 100_000
    """Time for which it goes on, for events that are late. Convention."""


DEFAULT_RECORDING, DEFAULT_RIG = RecordingSettings(), RigSettings()
