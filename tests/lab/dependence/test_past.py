"""How long ago: against a slow look at every pair of events."""

import numpy as np

from voltcam_lab.dependence.past import FAR_PIXELS, Past, past_of
from voltcam_simulator import EVENT

WIDTH, HEIGHT = 9, 7


def slowly(events: np.ndarray, i: int) -> list[int]:
    """Since the last event before the i-th of each kind; -1: there was none."""
    one = events[i]
    before = events[:i]
    dx, dy = (before[axis].astype(int) - int(one[axis]) for axis in ("x", "y"))
    near, same = np.abs(dx) + np.abs(dy) == 1, before["p"] == one["p"]
    own = (dx == 0) & (dy == 0)
    row, column = (dy == 0) & (np.abs(dx) > FAR_PIXELS), (dx == 0) & (np.abs(dy) > FAR_PIXELS)
    chosen = (own & same, own & ~same, near & same, near & ~same, row, column, np.ones(i, bool))
    return [int(one["t"] - before["t"][one_kind].max()) if one_kind.any() else -1 for one_kind in chosen]


def test_each_past_is_that_of_the_definition() -> None:
    rng = np.random.default_rng(4)
    events = np.zeros(400, EVENT)
    events["t"] = np.sort(rng.integers(0, 3000, 400))  # many share their time
    events["x"], events["y"] = rng.integers(0, WIDTH, 400), rng.integers(0, HEIGHT, 400)
    events["p"] = rng.random(400) < 0.6
    past = past_of(events, WIDTH, HEIGHT)
    assert past._fields == Past._fields
    for i in range(400):
        found = [int(one[i]) if one[i] < 1 << 50 else -1 for one in past]
        assert found == slowly(events, i)
