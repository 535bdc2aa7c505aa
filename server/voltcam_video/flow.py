"""Frames between two frames along the motion: dense optical flow both ways, both frames warped and blended.

For an instant t in 0..1 between V0 and V1, at a pixel x with velocity v (pixels per interval),

    l(x, t) = (1 - w) l0(x - t v) + w l1(x + (1 - t) v),    l = ln(V + DARK_DN)

- v: the flows F01 and F10 say where each frame's pixels go. By the first frame v is F01 at the place that
  comes to x, x - t F01(x) to first order; by the second likewise; 1 - t of the one and t of the other.
- w is t, but less where the second frame does not show what is at x, and more where the first does not: it
  leaves the image, or is covered, so that the other flow does not lead back (forward-backward check).
- Where the warped frames are no more alike than the frames as they are, flow means nothing, and the value is
  (1 - t) l0(x) + t l1(x). Alike is meant in structure: local means are free, so brightness may change. Fine
  flow makes any two images alike, so it must also lead back by the other flow, at some of the places around.

Logarithms are blended since pixels see these: of grey levels, what does not quite match would first brighten,
where it is dark, and then darken again; once a frame, ON events and then OFF ones that no camera gives.

It goes to V0 as t goes to 0 and to V1 as t goes to 1, smoothly: a jump at a real frame would be false events.

Sources: T. Kroeger et al., "Fast Optical Flow using Dense Inverse Search", ECCV 2016 (OpenCV's DIS); warping
and blending after H. Jiang et al., "Super SloMo", CVPR 2018, visibility measured instead of learned.
"""

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from voltcam_video.frame import Frame, Image
from voltcam_video.interval import DARK_DN, instants
from voltcam_video.opencv import cv2

MOST_STEPS = (
    12  # of "auto": 22 ms of one core at 346 x 260, two thirds of the time from frame to frame at 30 fps
)
SMALLEST_SIDE = 32  # pixels; OpenCV's DIS crashes on some smaller images (opencv/opencv issue 14554)
LARGE_SIDE = 128  # pixels: from here on, flow at half the resolution is as good, in a quarter of the time
PATCH = 4  # pixels of the image in which flow is found: half of DIS' own, for small things

OTHER_LIGHT = 0.3  # mean |change of ln L| left after warping: the light, or the scene, is another
DOUBT_PX2 = 1.0  # squared miss, of leading back or of the image, at which a place is half seen
LEAST_SEEN = 0.05  # keeps the weights smooth in time where neither frame shows a place
WINDOW = 11  # half-resolution pixels over which likeness is measured
NOISE_DN2 = 4.0  # variance of a half-resolution difference that may be noise alone
LEAST_EXPLAINED, WELL_EXPLAINED = 0.2, 0.5  # shares of the change at which flow begins to count, counts fully
LEAST_AGREED, WELL_AGREED = 0.1, 0.4  # likewise, shares of the places around that it leads back to
SMOOTH = 1.0  # half-resolution pixels: where flow ends beside the edge of a thing, light would jump
OBJECT = 4  # half-resolution pixels: things smaller than this square do not decide the number of steps

Plane = NDArray[Any]  # float32, (rows, columns) or (rows, columns, 2)


def along_flow(former: Frame, frame: Frame, steps: int | None = None) -> Iterator[Frame]:
    """The float32 frames that divide the interval into `steps`; None: so many that none moves over a pixel.

    Nothing between images of different or tiny sizes, and with None also where the light goes on or off.
    """
    v0, v1 = former.image, frame.image
    if v0.shape != v1.shape or min(v0.shape) < SMALLEST_SIDE or steps == 1:
        return
    motion = FrameMotion(v0, v1)
    for t_us, gone in instants(former.t_us, frame.t_us, steps or motion.steps):
        yield Frame(motion.image(gone), t_us)


class FrameMotion:
    """What moves from one image (H, W) to another; sides at least SMALLEST_SIDE.

    steps: as many as keep what moves below a pixel each, MOST_STEPS at most; 1 if the light goes on or off.
    """

    def __init__(self, v0: Image, v1: Image) -> None:
        self._v0: Plane = v0.astype(np.float32)
        self._v1: Plane = v1.astype(np.float32)
        self._log0, self._log1 = (np.log(v + np.float32(DARK_DN)) for v in (self._v0, self._v1))
        rows, columns = v0.shape
        # Where there is much, flow is no finer than half the resolution: all but the last warp happens there.
        self._half = (columns + 1) // 2, (rows + 1) // 2
        self._pixels: Plane = np.array([columns / self._half[0], rows / self._half[1]], np.float32)
        dis = _dis(large=min(v0.shape) >= LARGE_SIDE)
        bytes0, bytes1 = cv2.convertScaleAbs(v0), cv2.convertScaleAbs(v1)
        nothing: Any = None
        flow01 = self._smooth(dis.calc(bytes0, bytes1, nothing))
        flow10 = self._smooth(dis.calc(bytes1, bytes0, nothing))
        small0, small1 = self._shrunk(self._v0), self._shrunk(self._v1)
        self._first = self._tried(flow01, flow10, small0, small1)
        self._second = self._tried(flow10, flow01, small1, small0)
        alike = (self._first.left + self._second.left) / 2 < OTHER_LIGHT
        speed = max(self._first.speed, self._second.speed) if alike else 0.0
        self.steps = min(max(1, math.ceil(speed)), MOST_STEPS)

    def image(self, t: float) -> NDArray[np.float32]:
        """(H, W) at t: the first image at 0, the second at 1."""
        after, before = np.float32(t), np.float32(1 - t)
        flow01, seen0, trust0 = self._first.at(after)
        flow10, seen1, trust1 = self._second.at(before)
        share0, share1 = before * (seen1 + LEAST_SEEN), after * (seen0 + LEAST_SEEN)
        velocity = self._grown((before * flow01 - after * flow10) * self._pixels)
        weight = self._grown(share1 / (share0 + share1))
        trust = self._grown(before * trust0 + after * trust1)
        grid = _grid(self._v0.shape)
        moved0 = _warp(self._log0, grid - after * velocity, cv2.INTER_CUBIC)
        moved1 = _warp(self._log1, grid + before * velocity, cv2.INTER_CUBIC)
        still = self._log0 + after * (self._log1 - self._log0)
        log = still + trust * (moved0 + weight * (moved1 - moved0) - still)
        return np.asarray(np.maximum(np.exp(log) - np.float32(DARK_DN), 0), np.float32)

    def _tried(self, flow: Plane, back: Plane, here: Plane, there: Plane) -> "_Tried":
        """The flow of the half-resolution image `here`, tried against `there` and the flow from it back."""
        to = _grid(here.shape) + flow
        warped = _warp(there, to)
        edge = np.array(self._half, np.float32) - 1
        outside = _length2((to - np.clip(to, 0, edge)) * self._pixels) / DOUBT_PX2
        astray = _length2((flow + _warp(back, to)) * self._pixels) / DOUBT_PX2
        seen = 1 / (1 + outside + astray)
        change = _spread(here - there)
        explained = (change - _spread(here - warped)) / (change + NOISE_DN2)
        trust = np.clip((explained - LEAST_EXPLAINED) / (WELL_EXPLAINED - LEAST_EXPLAINED), 0, 1)
        agreed = cv2.blur(1 / (1 + astray), (WINDOW, WINDOW))
        trust *= np.clip((agreed - LEAST_AGREED) / (WELL_AGREED - LEAST_AGREED), 0, 1)
        # Flow out of the image cannot be tried: it is believed, but decides no number of steps.
        untried = cv2.dilate(outside / (1 + outside), np.ones((WINDOW, WINDOW), np.uint8))
        speed = np.sqrt(_length2(flow * self._pixels)) * trust * (1 - untried)
        left = np.abs(np.log((warped + DARK_DN) / (here + DARK_DN)))
        marks = np.dstack([seen, np.maximum(trust, untried)])
        return _Tried(flow, marks, float(_shrunk_by(OBJECT, speed).max()), float(left.mean()))

    def _smooth(self, flow: Plane) -> Plane:
        """Flow, blurred, in half-resolution pixels."""
        return cv2.GaussianBlur(self._shrunk(flow) / self._pixels, (0, 0), SMOOTH)

    def _shrunk(self, image: Plane) -> Plane:
        return cv2.resize(image, self._half, interpolation=cv2.INTER_AREA)

    def _grown(self, image: Plane) -> Plane:
        return cv2.resize(image, self._v0.shape[::-1], interpolation=cv2.INTER_LINEAR)


class _Tried(NamedTuple):
    """flow: half-resolution pixels. marks: seen in the other frame, trust in the flow; 0..1.

    speed: the fastest motion, pixels per interval. left: mean |change of ln L| after warping.
    """

    flow: Plane
    marks: Plane
    speed: float
    left: float

    def at(self, gone: np.float32) -> tuple[Plane, Plane, Plane]:
        """Flow, seen and trust of what is at each place when that share of the flow has gone by."""
        origin = _grid(self.flow.shape) - gone * self.flow
        seen, trust = cv2.split(_warp(self.marks, origin))
        return _warp(self.flow, origin), seen, trust


def _dis(large: bool) -> Any:
    """OpenCV's DIS for such an image: as fine as there is time for."""
    dis = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST)
    dis.setFinestScale(1 if large else 0)
    dis.setPatchSize(PATCH)
    dis.setPatchStride(3 if large else 2)
    return dis


@lru_cache(maxsize=8)
def _grid(shape: tuple[int, ...]) -> Plane:
    """(rows, columns, 2): x and y of each pixel of an image of that shape."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    return np.dstack([x, y]).astype(np.float32)


def _warp(image: Plane, at: Plane, how: int = cv2.INTER_LINEAR) -> Plane:
    nothing: Any = None
    return cv2.remap(image, at, nothing, how, borderMode=cv2.BORDER_REPLICATE)


def _length2(vectors: Plane) -> Plane:
    length2: Plane = np.einsum("ijk,ijk->ij", vectors, vectors)
    return length2


def _spread(difference: Plane) -> Plane:
    """Its variance over WINDOW around each pixel."""
    mean = cv2.blur(difference, (WINDOW, WINDOW))
    return np.maximum(cv2.blur(difference * difference, (WINDOW, WINDOW)) - mean * mean, 0)


def _shrunk_by(factor: int, image: Plane) -> Plane:
    size = image.shape[1] // factor, image.shape[0] // factor
    return cv2.resize(image, size, interpolation=cv2.INTER_AREA)
