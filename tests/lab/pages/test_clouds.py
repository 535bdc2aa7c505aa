"""Clouds of events: which part is shown, time surfaces, and what the figure has in it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.lab.pages.drawn import HEIGHT, REGION, WIDTH, some_events, with_data

from voltcam_lab.distances.inter_event_intervals import same_polarity
from voltcam_lab.pages.clouds import Window, busiest, clouds, time_surface
from voltcam_simulator import EVENT


def test_a_time_surface_is_each_pixels_last_event_decayed() -> None:
    events = np.array(
        [
            (1000, 11, 6, True),
            (4000, 11, 6, False),
            (5000, 9, 6, True),
            (7000, 13, 4, True),
            (7500, 10, 4, True),
        ],
        EVENT,
    )
    # One is beside the window, the last two are not before the instant.
    surface = time_surface(events, 7000, Window(0, 10, 4, side=4))
    assert surface[2, 1] == pytest.approx(-np.exp(-1))
    assert np.count_nonzero(surface) == 1


def test_a_window_is_fullest_behind_its_densest_events() -> None:
    events = np.zeros(60, EVENT)
    events["t"] = np.concatenate([np.arange(40) * 1000, 40_000 + np.arange(20) * 10])
    window = Window(0, 0, 0)
    assert window.fullest_us(events) == events["t"][-1] + 1
    assert replace(window, span_us=40_000).fullest_us(events) <= 40_000
    assert window.fullest_us(events[:0]) == window.span_us


def test_the_busiest_window_is_where_events_are() -> None:
    events = some_events(1, 5000)
    crowd = some_events(2, 20_000)
    crowd["t"] = np.sort(500_000 + crowd["t"] // 20)
    crowd["x"] = 70 + crowd["x"] % 20
    window = busiest(np.sort(np.concatenate([events, crowd]), order="t"), WIDTH, HEIGHT)
    assert window.begin_us <= 520_000 < window.begin_us + window.span_us
    assert window.x <= 70
    assert window.x + window.side >= 90
    assert busiest(events[:0], WIDTH, HEIGHT).begin_us == 0


@settings(deadline=None)
@given(begin_us=st.integers(-10, 30), x=st.integers(-3, 8), y=st.integers(-3, 8), side=st.integers(1, 6))
def test_a_window_has_the_events_that_are_inside_one_by_one(begin_us: int, x: int, y: int, side: int) -> None:
    rng = np.random.default_rng(3)
    events = np.zeros(200, EVENT)
    events["t"] = np.sort(rng.integers(0, 40, 200))
    events["x"], events["y"] = rng.integers(0, 8, (2, 200))
    window = Window(begin_us, x, y, span_us=9, side=side)
    wanted = [
        one
        for one in events.tolist()
        if begin_us <= one[0] < begin_us + 9 and x <= one[1] < x + side and y <= one[2] < y + side
    ]
    assert window.of(events).tolist() == wanted


def test_each_stream_has_its_cloud_its_surface_and_its_density() -> None:
    real, simulated = some_events(1), some_events(2)
    own = {name: same_polarity(events, REGION) for name, events in (("real", real), ("exact", simulated))}
    window = busiest(real, WIDTH, HEIGHT)
    figure = clouds({"real": real, "exact": simulated}, own, window)
    assert with_data(figure) == 2 + 2 + 3  # the real density is behind the other, too
    surfaces = [np.asarray(image.get_array()) for axes in figure.get_axes() for image in axes.images]
    for image, events in zip(surfaces, (real, simulated), strict=True):
        assert np.any(image)
        np.testing.assert_allclose(image, time_surface(events, window.fullest_us(real), window))
    titles = {axes.get_title() for axes in figure.get_axes()}
    assert {f"real\n{window.of(real).size} events", f"exact\n{window.of(simulated).size} events"} <= titles
