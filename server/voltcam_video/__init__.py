"""Frames in, with their times: the one place that knows OpenCV.

`open_source(request)` gives frames of anything that moves; `watch(request, stop, on_state)` keeps a camera
or stream open for as long as the daemon runs. Of this project it knows the client's readers of files only.
"""

from voltcam_video.clock import Clock
from voltcam_video.cubic import along_cubic
from voltcam_video.flow import along_flow
from voltcam_video.frame import Fit, Frame, Image, Outcome, fit, fit_labels, luminance
from voltcam_video.interval import follows
from voltcam_video.light import VIDEO_GAMMA, Levels
from voltcam_video.opencv import backends, use_one_thread
from voltcam_video.request import SourceRequest
from voltcam_video.sources import Granted, Source, SourceError, open_source
from voltcam_video.upsample import Upsampling, between
from voltcam_video.watch import SourceState, watch

__all__ = [
    "VIDEO_GAMMA",
    "Clock",
    "Fit",
    "Frame",
    "Granted",
    "Image",
    "Levels",
    "Outcome",
    "Source",
    "SourceError",
    "SourceRequest",
    "SourceState",
    "Upsampling",
    "along_cubic",
    "along_flow",
    "backends",
    "between",
    "fit",
    "fit_labels",
    "follows",
    "luminance",
    "open_source",
    "use_one_thread",
    "watch",
]
