"""Which part of a recording is looked at, and which is simulated: as much as there is time for."""

from dataclasses import replace

from voltcam_simulator.effect import Events

from ..light.scene import Scene
from ..recordings import Footage
from .reading import Reading

Cut = tuple[slice, slice]
"""Rows and columns."""

SIMULATED = 25e6  # pixels times images of light
FEWEST_FRAMES = 10  # by which events are told to be late
MOST_SAMPLES = 24_000_000  # pixels times frames that are fitted: 8 GB, where light follows motion


def middle(recording: Footage) -> Cut:
    """Rows and columns from the middle of the picture, such that there are MOST_SAMPLES at most."""
    frames = len(recording.frames)
    share = min(1.0, (MOST_SAMPLES / (frames * recording.width * recording.height)) ** 0.5)
    spans = []
    for side in (recording.height, recording.width):
        length = max(int(side * share), 1)
        spans.append(slice((side - length) // 2, (side - length) // 2 + length))
    return spans[0], spans[1]


def events_within(recording: Footage, cut: Cut) -> Events:
    """Those of a part of the picture, by its own rows and columns."""
    rows, columns = cut
    x, y = recording.events["x"], recording.events["y"]
    inside = (y >= rows.start) & (y < rows.stop) & (x >= columns.start) & (x < columns.stop)
    events: Events = recording.events[inside].copy()
    events["x"] -= columns.start
    events["y"] -= rows.start
    return events


def shortened(footage: Footage, reading: Reading, cut: Cut) -> tuple[Footage, Scene]:
    """What is simulated, from its beginning: SIMULATED at most, and a few frames at least."""
    scene = reading.scene
    images = max(int(SIMULATED / (scene.width * scene.height)), 2)
    end_us = max(int(scene.t_us[:images][-1]), int(scene.taken_us[:FEWEST_FRAMES][-1]))
    taken, filled = scene.taken_us <= end_us, scene.t_us <= end_us
    end_us = int(scene.taken_us[taken][-1])
    part = replace(
        footage,
        events=reading.events[reading.events["t"] <= end_us],
        width=scene.width,
        height=scene.height,
        frames=footage.frames[taken][:, *cut],
        frame_t_us=footage.frame_t_us[taken],
        exposure_us=None if footage.exposure_us is None else footage.exposure_us[taken],
    )
    light = replace(
        scene, taken=scene.taken[taken], taken_us=scene.taken_us[taken], images=scene.images[filled],
        t_us=scene.t_us[filled],
    )  # fmt: skip
    return part, light
