"""The light that a recording's frames tell of, as densely in time as a simulator needs it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from voltcam_video import Frame, Upsampling, between

from .grey import USUAL_DARK_DN, WHITE_DN
from .known import KnownLight
from .scale import is_black, is_white
from .spline import along_spline, out_of_step

How = Upsampling | Literal["spline"]
"""As in `voltcam_video.between`, or along a spline through all frames."""
CURVES: tuple[How, ...] = ("spline", "cubic")
_LEAST_CHANGE = 1e-6  # DN
_FEWEST_FRAMES, _FEWEST_PLACES = 8, 100  # that tell how surprise falls
_SLOW_FALL = 0.12  # of a spline: 0.07 to 0.16 where light is slow against frames
TRUSTED = 0.05  # of the brightness: a quarter of the contrast of a usual threshold
TRUSTED_ON_CURVES = 0.1
"""The same of light on a curve, for as small an error. Half way between frames of seven scenes, of 34 to 162
frames/s, errors (rms, where light changes) are 0.004 to 0.009 then, and 0.014 once; 0.005 to 0.029 along a
motion up to TRUSTED. Frames that are left out surprise a curve more than they do a motion."""
TOLERANCES = (TRUSTED, 0.1, 0.2, 0.4)  # where light trusted so far leaves too few events; the strictest first
ENOUGH_EACH = 400  # ON, and OFF events: leak alone makes only ON, which tells nothing of thresholds


@dataclass(frozen=True, eq=False)
class Scene:
    """The frames a camera took, and the light between them.

    taken: (M, H, W) grey levels [DN] at taken_us (M,) int64 ascending. images: (N, H, W) float32 at t_us
    (N,), the same with more between them, made as `how` says. Between two images light goes straight.
    """

    taken: NDArray[Any]
    taken_us: NDArray[np.int64]
    images: NDArray[np.float32]
    t_us: NDArray[np.int64]
    how: How = "linear"
    rounding: NDArray[np.float16] | None = None
    """`rounding_errors` of `taken`, where frames had been rounded."""
    white_dn: float = WHITE_DN
    """`scale.white_dn` of the frames."""

    @property
    def height(self) -> int:
        """Rows."""
        return int(self.images.shape[1])

    @property
    def width(self) -> int:
        """Columns."""
        return int(self.images.shape[2])

    @property
    def on_curves(self) -> bool:
        """Whether light between frames lies on curves through them; else it goes along a motion."""
        return self.how in CURVES

    @property
    def tolerance(self) -> float:
        """Of `trusted`, for one error half way between frames whichever way light was filled in."""
        return TRUSTED_ON_CURVES if self.on_curves else TRUSTED

    def frames(self) -> Iterator[Frame]:
        """The images, one by one."""
        for image, t_us in zip(self.images, self.t_us.tolist(), strict=True):
            yield Frame(image, t_us)

    @cached_property
    def surprise(self) -> NDArray[np.float32]:
        """How far each frame is from what the light between its neighbours says it should be [DN], (M,
        pixels).

        Between two frames one of which surprises, light is known less well than that.
        """
        missed = np.zeros((len(self.taken), self.height * self.width), np.float32)
        for first in (0, 1):
            left, left_us = self.taken[first::2], self.taken_us[first::2]
            images, times = _between(left, left_us, self.how)
            for k in range(first + 1, len(self.taken) - 1, 2):
                after = int(np.searchsorted(times, self.taken_us[k]))
                share = (self.taken_us[k] - times[after - 1]) / (times[after] - times[after - 1])
                guess = (1 - share) * images[after - 1] + share * images[after]
                missed[k] = np.abs(self.taken[k].astype(np.float32) - guess).ravel()
        return missed

    @cached_property
    def surprise_by_change(self) -> float:
        """Surprise of a frame over the change of light from frame to frame, where light is `trusted` before
        and behind: the median, in which a sample counts as much as light changes, as a share of it. 0: it
        never does."""
        taken = self.taken.reshape(len(self.taken), -1).astype(np.float32)
        trusted = self.trusted()
        there = trusted[1:] & trusted[:-1]
        change = np.abs(taken[2:] - taken[:-2])[there] / 2
        ratio = self.surprise[1:-1][there] / np.maximum(change, _LEAST_CHANGE)
        order = np.argsort(ratio)
        weight = np.cumsum((change / (taken[1:-1][there] + USUAL_DARK_DN))[order], dtype=np.float64)
        if not weight.size or weight[-1] == 0:
            return 0.0
        return float(ratio[order[np.searchsorted(weight, weight[-1] / 2)]])

    @cached_property
    def fall(self) -> float:
        """By what surprise falls when frames come twice as often: the median over pixels where every other
        frame alone surprises by a level or more, and light is `trusted`. Errors between frames fall likewise.

        1 along a motion: there the next fall may be anything. Where few pixels tell, that of slow light.
        """
        if not self.on_curves:
            return 1.0
        taken, taken_us = self.taken[::2], self.taken_us[::2]
        if len(taken) < _FEWEST_FRAMES:
            return _SLOW_FALL
        half = Scene(taken, taken_us, taken, taken_us, self.how).surprise[1:-1]
        trusted = self.trusted(self.tolerance)
        same = np.arange(2, 2 * len(half) + 1, 2)  # numbers of these frames in the whole
        there = (half > 1) & trusted[np.minimum(same, len(trusted) - 1)] & trusted[same - 1]
        if np.count_nonzero(there) < _FEWEST_PLACES:
            return _SLOW_FALL
        return min(float(np.median(self.surprise[same][there] / half[there])), 1.0)

    @cached_property
    def unsure(self) -> NDArray[np.float32]:
        """The largest surprise of a frame at a pixel or next to it, of the brightness; (M, H, W).

        No end where a pixel is white: how bright it was, the frame does not tell.
        """
        bright = self.taken.reshape(len(self.taken), -1).astype(np.float32) + USUAL_DARK_DN
        share = (self.surprise / bright).reshape(self.taken.shape)
        unsure = np.asarray(maximum_filter(share, size=(1, 3, 3)), np.float32)
        unsure[is_white(self.taken, self.white_dn)] = np.inf
        return unsure

    @cached_property
    def bow(self) -> NDArray[np.float32]:
        """How far the images between a frame and the next are from a straight line, at most, of the
        brightness; (M - 1, pixels)."""
        taken = self.taken.reshape(len(self.taken), -1).astype(np.float32)
        bow = np.zeros((len(taken) - 1, taken.shape[1]), np.float32)
        gap = np.clip(np.searchsorted(self.taken_us, self.t_us, side="right") - 1, 0, len(bow) - 1)
        for image, t_us, k in zip(self.images, self.t_us, gap, strict=True):
            share = np.float32((t_us - self.taken_us[k]) / (self.taken_us[k + 1] - self.taken_us[k]))
            straight = (1 - share) * taken[k] + share * taken[k + 1]
            dark = np.minimum(taken[k], taken[k + 1]) + USUAL_DARK_DN
            np.maximum(bow[k], np.abs(image.ravel() - straight) / dark, out=bow[k])
        return bow

    def with_rounding(self, rounding: NDArray[np.float16]) -> "Scene":
        """The same scene, and what rounding its frames has hidden."""
        return self._with(rounding=rounding)

    def in_columns(self, columns: NDArray[np.int64]) -> "Scene":
        """Some of its columns, ascending, with the surprise of the whole: their own would come from narrow
        strips."""
        if len(columns) == self.width:
            return self
        surprise = self.surprise.reshape(len(self.taken), self.height, self.width).take(columns, axis=2)
        part = replace(
            self,
            taken=self.taken.take(columns, axis=2),
            images=self.images.take(columns, axis=2),
            rounding=None if self.rounding is None else self.rounding.take(columns, axis=3),
        )
        part.__dict__["surprise"] = surprise.reshape(len(self.taken), -1)
        return part

    def later(self, by_us: float) -> "Scene":
        """The same scene, later by whole microseconds."""
        us = round(by_us)
        return self._with(taken_us=self.taken_us + us, t_us=self.t_us + us)

    def out_of_step(self) -> "Scene":
        """The same scene on its curve, with images at instants that do not keep step with the frames."""
        images, t_us = out_of_step(self.taken, self.taken_us, monotone=self.how == "cubic")
        return self._with(images=images, t_us=t_us)

    def _with(self, **changes: Any) -> "Scene":
        scene = replace(self, **changes)
        scene.__dict__["surprise"] = self.surprise  # of the same frames: not once more
        return scene

    def trusted(self, tolerance: float = TRUSTED) -> NDArray[np.bool_]:
        """Where the light between frame k and the next is known well enough to say when an event is due.

        (M - 1, pixels). No surprise of more than `tolerance` of the brightness in either frame, nor next to
        it, and neither of them black, nor an image between them: how dark it was, they do not tell. The same
        goes for white.
        """
        good: NDArray[np.bool_] = self.unsure.reshape(len(self.taken), -1) < tolerance
        black, white = self._at_an_end
        return good[:-1] & good[1:] & ~black & ~white

    def known(self, tolerance: float = TRUSTED) -> KnownLight:
        """Where light is `trusted`."""
        return KnownLight(self.trusted(tolerance), self.taken_us, self.width)

    def black(self) -> KnownLight:
        """Where it is black at a frame or between, and nowhere white: all is known there but how dark it
        was."""
        black, white = self._at_an_end
        return KnownLight(black & ~white, self.taken_us, self.width)

    def white(self) -> KnownLight:
        """Where it is white at a frame or between, and nowhere black."""
        black, white = self._at_an_end
        return KnownLight(white & ~black, self.taken_us, self.width)

    @cached_property
    def _at_an_end(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """(M - 1, pixels) each: whether a frame, the next, or an image between them is black, and white."""
        taken = self.taken.reshape(len(self.taken), -1)
        black, white = is_black(taken), is_white(taken, self.white_dn)
        black, white = black[:-1] | black[1:], white[:-1] | white[1:]
        gap = np.clip(np.searchsorted(self.taken_us, self.t_us, side="right") - 1, 0, len(black) - 1)
        most = taken.max(initial=0)  # curves rise above what frames can tell
        for image, k in zip(self.images, gap, strict=True):
            black[k] |= is_black(image.ravel())
            white[k] |= is_white(np.minimum(image.ravel(), most), self.white_dn)
        return black, white

    def doubt(self, pixel: NDArray[np.int32], t_us: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far the light may be from what `images` have [DN], for pixels (n,) at times (n,).

        The larger surprise of the frames about it in the middle between them, nothing at a frame.
        """
        k = np.clip(np.searchsorted(self.taken_us, t_us, side="right") - 1, 0, len(self.taken_us) - 2)
        phase = np.clip((t_us - self.taken_us[k]) / (self.taken_us[k + 1] - self.taken_us[k]), 0, 1)
        larger = np.maximum(self.surprise[k, pixel], self.surprise[k + 1, pixel])
        return np.asarray(4 * phase * (1 - phase) * larger)


def scene_of(taken: NDArray[Any], taken_us: NDArray[np.int64], how: How = "auto") -> Scene:
    """The scene of frames (M, H, W) at taken_us (M,), with light between them."""
    return Scene(taken, taken_us, *_between(taken, taken_us, how), how)


def _between(
    taken: NDArray[Any], taken_us: NDArray[np.int64], how: How
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Images (N, H, W) and their times (N,): the frames, and light between them."""
    if how == "spline":
        return along_spline(taken, taken_us)
    frames = map(Frame, taken, taken_us.tolist())
    dense = list(between(frames, how))
    images = np.stack([frame.image for frame in dense]).astype(np.float32, copy=False)
    return images, np.array([frame.t_us for frame in dense], np.int64)
