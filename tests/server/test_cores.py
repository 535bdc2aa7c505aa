"""How many threads a sensor has: what the process may use, where there is work for them."""

import os

import pytest

from voltcam_server.cores import threads_for


def test_a_large_sensor_has_all_cores_of_this_process() -> None:
    if not hasattr(os, "sched_setaffinity"):
        pytest.skip("this system cannot bind a process to cores")
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert threads_for(1280, 720) == 1
    finally:
        os.sched_setaffinity(0, allowed)
    assert 1 <= threads_for(1280, 720) <= len(allowed)


@pytest.mark.parametrize("size", [(1, 1), (128, 128), (240, 180)])
def test_a_small_one_has_one(size: tuple[int, int]) -> None:
    assert threads_for(*size) == 1


@pytest.mark.parametrize("size", [(240, 180), (346, 260)])
def test_a_small_one_that_waits_for_frames_has_one(size: tuple[int, int]) -> None:
    assert threads_for(*size, live=True) == 1
