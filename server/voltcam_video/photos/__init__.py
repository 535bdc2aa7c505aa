"""Scenes from photographs: planes that move under smooth homographies and hide each other, with exact flow.

`PhotoScene`: arrays in, arrays out. `PhotoFolder` reads photographs from the disk.
"""

from voltcam_video.photos.folder import PhotoFolder, UnreadablePhotographError
from voltcam_video.photos.light import light_of, smaller
from voltcam_video.photos.motion import PlaneMotion, displaced
from voltcam_video.photos.scene import LAYERS, SPEED_PX_S, PhotoScene

__all__ = [
    "LAYERS",
    "SPEED_PX_S",
    "PhotoFolder",
    "PhotoScene",
    "PlaneMotion",
    "UnreadablePhotographError",
    "displaced",
    "light_of",
    "smaller",
]
