"""Where light is known, event by event, against looking it up one by one."""

import numpy as np
import pytest

from voltcam_lab.light.known import SETTLED_US, KnownLight
from voltcam_simulator import EVENT

WIDTH, HEIGHT = 5, 4
TAKEN_US = np.array([100, 200, 350, 400, 700, 1000])


@pytest.fixture(scope="module")
def known() -> KnownLight:
    gaps = np.random.default_rng(1).random((5, HEIGHT * WIDTH)) < 0.6
    return KnownLight(gaps, TAKEN_US, WIDTH)


def events(n: int = 400) -> np.ndarray:
    """In no order, from before the first frame to after the last one, some on frames."""
    rng, made = np.random.default_rng(2), np.zeros(n, EVENT)
    made["t"] = rng.integers(0, 1100, n)
    made["t"][:20] = rng.choice(TAKEN_US, 20)
    made["x"], made["y"] = rng.integers(0, WIDTH, n), rng.integers(0, HEIGHT, n)
    return made


def gap_of(t_us: int) -> int | None:
    """That which begins with the frame before; the last frame ends the last one."""
    if t_us == TAKEN_US[-1]:
        return 4
    return next((k for k in range(5) if TAKEN_US[k] <= t_us < TAKEN_US[k + 1]), None)


def test_an_event_is_within_if_its_pixels_light_is_known_between_the_frames_about_it(
    known: KnownLight,
) -> None:
    made = events()
    wanted = [
        (gap := gap_of(t)) is not None and bool(known.gaps[gap, y * WIDTH + x])
        for t, x, y, _ in made.tolist()
    ]
    assert known.within(made).tolist() == wanted
    assert (known.where(made) == made[np.array(wanted)]).all()
    assert 0 < sum(wanted) < len(wanted)


def test_stretches_are_the_same_where_light_has_been_known_all_the_time(known: KnownLight) -> None:
    """Of any two events of a pixel that are within."""
    made = known.where(events())
    stretch, pixel = known.stretch(made), made["y"].astype(int) * WIDTH + made["x"]
    for p in range(WIDTH * HEIGHT):
        own = np.flatnonzero(pixel == p)
        for i in own:
            for j in own:
                first, last = sorted((gap_of(made["t"][i]), gap_of(made["t"][j])))
                assert (stretch[i] == stretch[j]) == known.gaps[first : last + 1, p].all()


def test_the_first_event_after_light_that_is_not_known_is_not_settled_unless_it_is_late() -> None:
    """One pixel beside one whose light is known all the time; times in frames of SETTLED_US / 5."""
    taken_us = np.arange(0, 21) * SETTLED_US // 5
    gaps = np.ones((20, 2), np.bool_)
    gaps[8, 0] = False
    known = KnownLight(gaps, taken_us, 2)
    rows = [(0, 1.5), (0, 1.7), (1, 3.0), (1, 6.0), (0, 9.5), (1, 9.5), (0, 9.6), (0, 16.0)]
    made = np.zeros(len(rows), EVENT)
    made["x"], made["t"] = [x for x, _ in rows], [at * SETTLED_US / 5 for _, at in rows]
    wanted = [False, True, False, True, False, True, True, True]
    assert known.settled(made).tolist() == wanted
    backwards = np.argsort(-made["t"], kind="stable")
    assert known.settled(made[backwards]).tolist() == np.array(wanted)[backwards].tolist()
    alone = made[[4]].copy()
    for at, late in ((13.9, False), (14.1, True)):  # half a second after light is known again
        alone["t"] = at * SETTLED_US / 5
        assert known.settled(alone).tolist() == [late]


def test_everywhere_is_between_all_frames() -> None:
    known, made = KnownLight.everywhere(TAKEN_US, HEIGHT, WIDTH), events()
    inside = (made["t"] >= TAKEN_US[0]) & (made["t"] <= TAKEN_US[-1])
    assert (known.within(made) == inside).all()
    assert (known.stretch(made[inside]) == -1).all()


def test_all_around_is_known_before_and_behind_too(known: KnownLight) -> None:
    found = known.all_around()
    for k in range(5):
        assert (found.gaps[k] == known.gaps[max(k - 1, 0) : k + 2].all(axis=0)).all()
