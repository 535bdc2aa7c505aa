"""Calibration by the law of first passage: the likeliest parameters, what is not the pixels', refinement."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from voltcam_simulator import Parameters

from ..distances import FrameLight, Region
from ..health import Inspection
from .bus import as_read
from .calibrate import Calibration, calibrate
from .camera_frames import filmed, with_frames_of
from .estimates import Estimate
from .lateness import as_late_as, clocks_apart_us
from .part import SIMULATED, Cut, shortened
from .reading import Reading
from .refine.refinement import Refined, Refinement, known_share
from .scatter import as_scattered

MOSTLY_KNOWN = 0.5  # of the events: by fewer, parameters would make up for light that is not known


@dataclass(frozen=True, eq=False)
class Exact:
    """What the exact method finds: of each, see `Calibrated`."""

    parameters: Parameters
    calibration: Calibration
    estimates: tuple[Estimate, ...]
    refined: Refined | None
    moved: tuple[tuple[str, float, float], ...]
    notes: list[str]


@dataclass(frozen=True, eq=False)
class ExactMethod:
    """On the part of a recording that is read. report: is told of each step."""

    inspection: Inspection
    reading: Reading
    cut: Cut
    seed: int
    report: Callable[[str], None]

    def found(self, base: Parameters | None, refining: bool) -> Exact:
        """base: what other effects are taken from for the simulations. Raises CalibrationError."""
        found = calibrate(self.reading, self.seed, self.report, clocks_apart_us(self.inspection.lag))
        pixels, notes = found.parameters, _notes_of(found)
        if base and refining:
            pixels = base.changed(pixels.model_dump(exclude_defaults=True))
        parameters, said = self._with_camera(pixels)
        refined, likeliest, worth = None, parameters, False
        moved: tuple[tuple[str, float, float], ...] = ()
        share = known_share(self.reading.events, self.reading.scene) if refining else 0.0
        if share >= MOSTLY_KNOWN:
            refined = self._refinement(parameters).refined(parameters, same_light=True)
            worth = refined.closer
            notes.append(_told(refined, worth))
            parameters = refined.parameters if worth else likeliest
        elif refining:
            notes.append(
                "only black, white, spread of thresholds and noise of the frames were tried by simulation: "
                f"{share:.0%} of the events come where light between frames is known; for the rest, record "
                "slower motion, or at a higher frame rate"
            )
        if refining:
            parameters = self._beside_light(parameters, settling=worth)
        if _moved(likeliest, parameters):  # what frames do is fitted to the pixels as they are now
            frames = {"aps_coupling": pixels.aps_coupling.model_dump()}
            parameters, said = self._with_camera(parameters.changed(frames))
            moved = _moved(likeliest, parameters)
        estimates = tuple(
            one.reaching(getattr(getattr(parameters, one.effect), one.parameter)) for one in found.estimates
        )
        return Exact(parameters, found, estimates, refined, moved, notes + said)

    def _with_camera(self, parameters: Parameters) -> tuple[Parameters, list[str]]:
        """What is the camera's and not the pixels': how late its events are, what its frames do to them, and
        how they are read; with what was found, in words."""
        self.report("delay")
        inspection, cut, seed = self.inspection, self.cut, self.seed
        parameters, notes = as_read(inspection, parameters)
        footage, scene = shortened(inspection.footage, self.reading, cut)
        parameters, late = as_late_as(footage, scene, parameters, seed)
        notes.append(late)
        rows, columns = cut
        if (rows.stop - rows.start, columns.stop - columns.start) != inspection.footage.frames.shape[1:]:
            few = "of so long a recording only the middle is looked at"
            return parameters, [*notes, f"what the camera's frames do was not fitted: {few}"]
        parameters, frames = with_frames_of(inspection, scene, footage, parameters, seed, self.report)
        if not frames:
            return parameters, notes
        simulated = filmed(footage, scene, parameters, seed)
        parameters, scatter = as_scattered(footage, simulated, parameters)
        return parameters, notes + ([frames, scatter] if scatter else [frames])

    def _refinement(self, parameters: Parameters) -> Refinement:
        """The camera will see other scenes, so light is what it is there: frames, and what is between them.

        Where what frames do to events is in the parameters, events about exposures count as all others. Else
        they are left out.
        """
        return Refinement(
            self.reading.events, self.reading.scene, self._light, self._region(parameters), self.seed,
            self.report, SIMULATED,
        )  # fmt: skip

    def _beside_light(self, start: Parameters, settling: bool) -> Parameters:
        """What the frames' black and white stand for, and what of spread and noise is the light's. settling:
        all else is found anew with these."""
        refinement = self._refinement(start)
        found = refinement.with_ends(start)
        found = refinement.with_spread_and_slack(found, self.inspection.subject.light.noise_dn)
        return refinement.settled(found) if settling else found

    @property
    def _light(self) -> FrameLight:
        footage = self.inspection.footage
        return FrameLight(np.asarray(footage.frames[:, *self.cut], np.uint8), footage.frame_t_us)

    def _region(self, parameters: Parameters) -> Region:
        scene, t_us = self.reading.scene, self.inspection.footage.frame_t_us
        region = Region.whole(scene.width, scene.height, int(t_us[0]), int(t_us[-1])).on(self.reading.keep)
        if parameters.aps_coupling.active:
            return region
        return region.without(self.inspection.exposure_windows)


def _moved(before: Parameters, after: Parameters) -> tuple[tuple[str, float, float], ...]:
    """What differs by more than a thousandth, by name."""
    found = []
    old, new = before.model_dump(), after.model_dump()
    for effect, values in new.items():
        for name, value in (values if isinstance(values, dict) else {}).items():
            former = old[effect][name]
            if isinstance(value, float) and abs(value - former) > 1e-3 * max(abs(value), abs(former)):
                found.append((f"{effect}.{name}", float(former), value))
    return tuple(found)


def _told(refined: Refined, worth: bool) -> str:
    score = f"{refined.before:.3g} to {refined.after:.3g} on pixels that no step was judged by (0: the same)"
    if not worth:
        return f"parameters are the likeliest: others that were tried behave no more alike, {score}"
    return f"parameters were moved to behave as the recording does: difference from {score}"


def _notes_of(found: Calibration) -> list[str]:
    notes = [
        f"fitted to {found.events} intervals between events of a pixel; {found.fit.own:.0%} of these are "
        f"as the model has them; light trusted to {found.reading.tolerance:.0%}"
    ]
    for (first, second), value in found.correlations.items():
        notes.append(f"{first} and {second} are correlated {value:+.2f}")
    guessed = [f"{one.effect}.{one.parameter}" for one in found.estimates if one.rests_on == "prior"]
    if guessed:
        notes.append(
            f"not determined by this recording, any value in the interval will do: {', '.join(guessed)}"
        )
    return notes
