"""A camera for the tests of calibration and diagnosis that shares no code with the simulator or the lab.

As in

    rng = np.random.default_rng(7)
    scene, base = draw_scene(rng), draw_base(rng)
    recording = record(scene, base, [draw_effect(rng, "refractory_period", "strong")], seed=1)

whose `events`, `frames` and `frame_t_us` are what a diagnosis may see and whose `truth` is the answer.
"""

from .base import PUBLISHED, Base, draw_base
from .effects import LEVELS, LISTED, UNLISTED, Effect, draw_effect
from .fine_scene import draw_fine_scene
from .frames import FAULTS, STRAIGHT, Film, draw_film
from .photo_scene import draw_photo_scene
from .recording import EVENT, Recorded, record, shuffled_polarity
from .scene import Scene, draw_scene, still_scene

__all__ = [
    "EVENT", "FAULTS", "LEVELS", "LISTED", "PUBLISHED", "STRAIGHT", "UNLISTED",
    "Base", "Effect", "Film", "Recorded", "Scene",
    "draw_base", "draw_effect", "draw_film", "draw_fine_scene", "draw_photo_scene", "draw_scene", "record",
    "shuffled_polarity", "still_scene",
]  # fmt: skip
