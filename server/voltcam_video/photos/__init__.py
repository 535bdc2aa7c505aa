"""Scenes from photographs: planes that move under smooth homographies and hide each other, with exact flow.

Arrays in, arrays out; `sources/photos.py` reads the folder.
"""

from voltcam_video.photos.light import light_of
from voltcam_video.photos.motion import PlaneMotion, displaced
from voltcam_video.photos.scene import LAYERS, SPEED_PX_S, PhotoScene

__all__ = ["LAYERS", "SPEED_PX_S", "PhotoScene", "PlaneMotion", "displaced", "light_of"]
