"""A blob tracker, tried on a simulated camera: docs/start/test-your-algorithm.md, as one script.

.venv/bin/python docs/start/tracker.py
"""

import numpy as np
from voltcam_simulator import Parameters, Simulator

WIDTH, HEIGHT, RADIUS = 64, 48, 5  # pixels
FRAME_US, END_US = 2000, 1_000_000


def truth(t_us):
    """Centre of the disc at t_us, x and y in pixels: a circle in one second."""
    turn = 2 * np.pi * t_us / 1e6
    return 32 + 14 * np.cos(turn), 24 + 14 * np.sin(turn)


def frame(t_us):
    """What the camera looks at: a bright disc on grey, its edge one pixel soft. Grey levels, (48, 64)."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    cx, cy = truth(t_us)
    inside = np.clip(RADIUS + 0.5 - np.hypot(x - cx, y - cy), 0, 1)
    return 80 + 100 * inside


def record(**changes):
    """A second of events of a DAVIS346 with some parameters changed."""
    parameters = Parameters.of("typical").changed(changes)
    simulator = Simulator(WIDTH, HEIGHT, parameters, seed=1)
    times_us = range(0, END_US, FRAME_US)
    return np.concatenate([simulator.advance(frame(t_us), t_us) for t_us in times_us])


def track(events, window_us=10_000):
    """The mean place of the events of each window: times (N,) in us, x and y (N,) in pixels."""
    window = events["t"] // window_us
    first = window[0]
    window -= first
    count = np.bincount(window)
    seen = count > 0
    x, y = (np.bincount(window, events[axis])[seen] / count[seen] for axis in ("x", "y"))
    return (first + np.flatnonzero(seen) + 0.5) * window_us, x, y


def error_px(events):
    """How far the tracker is from the truth: mean distance in pixels; nan where it says nothing."""
    if len(events) == 0:
        return np.nan
    t_us, x, y = track(events)
    true_x, true_y = truth(t_us)
    return np.hypot(x - true_x, y - true_y).mean()


def supported(events, within_us=5000):
    """The events that had an event on a neighbouring pixel shortly before."""
    last = np.full((HEIGHT + 2, WIDTH + 2), -1_000_000)
    kept = np.zeros(len(events), bool)
    for i, (t, x, y, _) in enumerate(events.tolist()):
        around = last[y : y + 3, x : x + 3].copy()
        around[1, 1] = -1_000_000  # a pixel does not support itself
        kept[i] = t - around.max() <= within_us
        last[y + 1, x + 1] = t
    return events[kept]


print("temperature   events   error  with filter")
for temperature_c in (25, 45, 65, 85, 105, 125):
    events = record(temperature_c=temperature_c)
    print(f"{temperature_c:9} C {len(events):8} {error_px(events):7.1f} {error_px(supported(events)):12.1f}")

print("threshold     events   error  with filter")
for theta in (0.25, 0.5, 1, 2, 3, 4):
    events = record(comparator={"theta_on": theta, "theta_off": theta})
    print(f"{theta:9}   {len(events):8} {error_px(events):7.1f} {error_px(supported(events)):12.1f}")
