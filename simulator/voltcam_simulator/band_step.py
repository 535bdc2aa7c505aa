"""One step of one band: the light and response that its effects give, drift and noise, events."""

import numpy as np

from .band_state import BandState
from .crossings import cross
from .effect import Band, Image, overrides
from .fixed_pattern import FixedPattern
from .groups import Reset
from .kicks import kicks_of
from .law import Law
from .out_of_reach import accumulate, add_response
from .paper_law import cross_by_paper
from .plane_kernels import add_independent


class BandStepper:
    """Takes bands through steps, by a law and the effects of a pattern."""

    def __init__(self, law: Law, pattern: FixedPattern) -> None:
        self._law: Law = law
        self._sensor = pattern.sensor
        self._reset = Reset(pattern.sensor.refractory_us, pattern.sensor.reset_sigma)
        self._see, self._respond, self._drift = (
            [effect for effect in pattern.effects if overrides(effect, stage)]
            for stage in ("see", "respond", "drift")
        )

    @property
    def instant(self) -> bool:
        """Whether several steps may be seen in one call."""
        return all(effect.instant for effect in (*self._see, *self._respond, *self._drift))

    def see(self, state: BandState, image: Image, start_us: int, span_us: float, elapsed_us: float) -> Band:
        """A band at the end of a step: light and response there. image (pixels,): the whole sensor's."""
        band = state.band
        band.start_us, band.span_us, band.elapsed_us = start_us, span_us, elapsed_us
        band.light[:] = image[state.first_pixel : state.first_pixel + band.light.size]
        self.respond(band)
        return band

    def respond(self, band: Band) -> None:
        """From the light of an image, which the band has, to the light and response that its effects give."""
        band.response.fill(0)
        band.is_bent = False
        for effect in self._see:
            effect.see(band)
        for effect in self._respond:
            effect.respond(band)

    def add_drift(self, band: Band) -> None:
        """Drift and noise of a step, of all effects but the response."""
        band.temperature_c, band.noise2, band.kicks = self._sensor.temperature_c, None, []
        band.drift.fill(0)
        band.noise.fill(0)
        for effect in self._drift:
            effect.drift(band)
        if band.noise2 is not None:
            band.apply(add_independent, band.noise, band.noise2)

    def draw_events(self, state: BandState, key: np.uint64, offset_us: float) -> None:
        """Follow a band's voltages over the step that it has seen; its event keys go into its workspace."""
        band, pixels, motion, workspace = state.band, state.pixels, state.motion, state.workspace
        add_response(band.light, band.response, band.drift, state.light, state.response)
        # The fields of a `Step`: a plain tuple is made 0.3 us sooner, which a small sensor feels.
        step = key, band.span_us, offset_us, state.first_pixel, state.width
        if self._law == "paper":
            workspace.draw(
                band.drift.size, lambda done, keys: cross_by_paper(*pixels, *motion, *step, done, keys)
            )
            return
        kicks, in_reach = state.no_kicks, pixels
        if band.kicks:
            kicks = kicks_of(band)
            by_row = band.drift.reshape(-1, state.width)
            by_row += kicks.sizes.sum(axis=0)[:, None]
            in_reach = pixels._replace(above=pixels.above - kicks.slack, below=pixels.below - kicks.slack)
        near, bent, reset, bend = workspace.near, workspace.bent, self._reset, band.bend
        careful = state.has_held or kicks is not state.no_kicks
        straight, curved = accumulate(
            *in_reach, *motion, bend.bow, band.span_us, state.width, state.rows.ahead, near, bent
        )
        near, bent = near[:straight], bent[:curved]
        workspace.draw(straight + curved, lambda done, keys: cross(
            *pixels, *motion, *step, *reset, *kicks, *bend, careful, near, bent, done, keys,
        ))  # fmt: skip
