"""Recordings that are made up: a healthy one, and what gives it faults."""

import os
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_lab.health import Health, Inspection, inspect
from voltcam_lab.recordings import Footage, load

WIDTH, HEIGHT = 64, 48
PERIOD_US = 25_000
THRESHOLD = 0.25
START_US = 1_700_000_000_000_000
LEAK_HZ = 0.5
LATENCY_US = 3000

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[4] / "shared" / "data"))


def light(t_s: float) -> np.ndarray:
    """Waves that go to and fro on the right, steps of grey at rest on the left; 25 to 200 DN."""
    y, x = np.mgrid[:HEIGHT, :WIDTH].astype(np.float64)
    shift = 6 * np.sin(2 * np.pi * 1.5 * t_s)
    moving = 85 + 30 * (np.sin((x - shift) / 2.5) + np.sin((y + 0.6 * shift + 0.3 * x) / 3.1))
    at_rest = 25 + 25 * (y // 6)
    return np.where(x < WIDTH // 2, at_rest, moving)


@cache
def healthy(seconds: float = 4.0, seed: int = 1) -> Footage:
    """An ideal pixel in steps of 1 ms, a leak, a latency; frames at 40 fps with noise."""
    rng = np.random.default_rng(seed)
    memory = np.log(light(0)) + rng.uniform(-THRESHOLD, THRESHOLD, (HEIGHT, WIDTH))
    parts = []
    for t_ms in range(1, round(1000 * seconds)):
        level = np.log(light(t_ms / 1000))
        for sign in (1, -1):
            ys, xs = np.nonzero(sign * (level - memory) >= THRESHOLD)
            memory[ys, xs] += sign * THRESHOLD
            t_us = 1000 * t_ms + rng.integers(-1000, 0, ys.size) + LATENCY_US
            parts.append(np.rec.fromarrays([t_us, xs, ys, np.full(ys.size, sign > 0)], EVENT))
    leaks = rng.poisson(LEAK_HZ * seconds * WIDTH * HEIGHT)
    columns = (rng.integers(0, n, leaks) for n in (round(1e6 * seconds), WIDTH, HEIGHT))
    parts.append(np.rec.fromarrays([*columns, np.ones(leaks)], EVENT))
    t_us = np.arange(0, round(1e6 * seconds), PERIOD_US)
    frames = np.stack([light(t / 1e6) for t in t_us]) + rng.normal(0, 1, (t_us.size, HEIGHT, WIDTH))
    return recording_of(np.concatenate(parts), np.rint(frames).clip(0, 255).astype(np.uint8), t_us)


def recording_of(events: np.ndarray, frames: np.ndarray, t_us: np.ndarray) -> Footage:
    events = np.sort(np.asarray(events, EVENT), order="t", kind="stable")
    events["t"] += START_US
    return Footage(events, WIDTH, HEIGHT, frames, t_us + START_US)


def with_events(recording: Footage, more: np.ndarray) -> Footage:
    events = np.concatenate([recording.events, more])
    return replace(recording, events=np.sort(events, order="t", kind="stable"))


def some_events(t_us: Any, x: Any, y: Any, p: Any) -> np.ndarray:
    columns = np.broadcast_arrays(t_us, x, y, p)
    return np.rec.fromarrays([column.ravel() for column in columns], EVENT)


@cache
def well() -> Inspection:
    return inspect(healthy())


def frame_locked(rows_us: float, count: int = 60) -> Footage:
    """ON bursts from 400 to 700 us after each frame, later by rows_us per row."""
    rng = np.random.default_rng(7)
    frames = np.repeat(healthy().frame_t_us, count)
    y = rng.integers(0, HEIGHT, frames.size)
    t_us = frames + 400 + rng.integers(0, 300, frames.size) + np.rint(rows_us * y).astype(int)
    return with_events(healthy(), some_events(t_us, rng.integers(0, WIDTH, frames.size), y, True))


def only_fatal(recording: Footage, name: str, words: str) -> Health:
    """Its health, in which that one finding is fatal."""
    health = inspect(recording).health
    assert not health.usable
    assert [finding.name for finding in health.fatal] == [name]
    assert words in health[name].words
    assert health.text().startswith("This recording cannot be used: ")
    assert all("\n" not in finding.words for finding in health.findings)
    return health


def real(name: str) -> Footage:
    if not (DATA / name).exists():
        pytest.skip(f"no {name} in ../shared/data or $VOLTCAM_DATA")
    return load(DATA / name)
