"""The space of one thread: it grows until all events fit, and no further than it may."""

from collections.abc import Callable

import numpy as np
import pytest

from voltcam_simulator.limits import Limits, TooLongError, TooManyEventsError
from voltcam_simulator.workspace import FIRST_KEYS, Keys, Workspace


def write_up_to(per_pixel: int, sizes: list[int]) -> Callable[[int, Keys], tuple[int, int]]:
    """A kernel's part: each pixel gives so many keys, and it stops before one whose keys do not fit."""

    def draw(done: int, keys: Keys) -> tuple[int, int]:
        sizes.append(keys.size)
        fit = min(keys.size // per_pixel, 5 - done)
        keys[: fit * per_pixel] = np.repeat(np.arange(done, done + fit), per_pixel)
        return done + fit, fit * per_pixel

    return draw


def test_space_grows_until_all_pixels_are_done_and_keeps_what_is_there() -> None:
    workspace = Workspace(8)
    sizes: list[int] = []
    workspace.draw(5, write_up_to(FIRST_KEYS - 1, sizes))
    assert workspace.take_keys().tolist() == np.repeat(np.arange(5), FIRST_KEYS - 1).tolist()
    assert sizes[0] == FIRST_KEYS
    assert len(sizes) > 1
    assert workspace.take_keys().size == 0


def test_what_two_bands_draw_stands_one_behind_the_other() -> None:
    workspace = Workspace(8)
    for _ in range(2):
        workspace.draw(5, write_up_to(2, []))
    assert workspace.take_keys().tolist() == 2 * np.repeat(np.arange(5), 2).tolist()


def test_forgetting_gives_the_space_back() -> None:
    workspace = Workspace(8)
    workspace.draw(5, write_up_to(FIRST_KEYS, []))
    assert workspace.event_bytes >= 5 * 8 * FIRST_KEYS
    workspace.forget_keys()
    assert workspace.event_bytes == 8 * FIRST_KEYS
    assert workspace.take_keys().size == 0


def test_it_stops_at_the_limits() -> None:
    workspace = Workspace(8)
    workspace.most_keys = 2 * FIRST_KEYS
    with pytest.raises(TooManyEventsError):
        workspace.draw(5, write_up_to(FIRST_KEYS, []))
    workspace = Workspace(8)
    workspace.limits = Limits(late=lambda: True)
    workspace.draw(5, write_up_to(1, []))  # nothing to wait for
    with pytest.raises(TooLongError):
        workspace.draw(5, write_up_to(FIRST_KEYS, []))


def test_memory_is_that_of_the_planes() -> None:
    workspace = Workspace(100)
    assert workspace.nbytes == 100 * 4 * (6 + 1) + 2 * 101 * 4
