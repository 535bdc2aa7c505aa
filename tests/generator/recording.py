"""`record`: a scene through a camera, as frames and events, with the truth beside them."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base import Base
from .effects import Effect, wire
from .frames import STRAIGHT, Film, exposed
from .readout import read_out
from .scene import Scene
from .wires import Floats, events_of, plain

EVENT = np.dtype([("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "?")])


@dataclass(frozen=True)
class Recorded:
    events: NDArray[Any]  # EVENT, sorted by t
    frames: NDArray[Any]  # (N, height, width) uint8, or float32 where not eight_bit; DN
    frame_t_us: NDArray[np.int64]  # mid-exposure, from 0 to the end
    width: int
    height: int
    truth: dict[str, Any]


def record(
    scene: Scene,
    base: Base,
    effects: Sequence[Effect] = (),
    seconds: float = 6.0,
    fps: float = 200,
    seed: int = 0,
    eight_bit: bool = True,
    step_us: float = 200.0,
    film: Film = STRAIGHT,
    camera_seed: int | None = None,
) -> Recorded:
    """seed: of all noise. camera_seed: of fixed patterns, which recordings of one camera share; None: seed.
    film: what the frames get wrong. step_us: at most 400."""
    if not 0 < step_us <= 400:
        raise ValueError(f"step_us={step_us}: take at most 400, pulses shorter than a step would be lost")
    streams = np.random.SeedSequence(seed).spawn(2 + 2 * len(effects))
    rngs = [np.random.default_rng(stream) for stream in streams]
    own = [] if camera_seed is None else np.random.default_rng(camera_seed).spawn(2 * len(effects))
    frame_t_us = np.round(np.arange(int(seconds * fps + 1e-9) + 1) * 1e6 / fps).astype(np.int64)
    wires = plain(base, scene, seconds, step_us, frame_t_us)
    for n, effect in enumerate(effects):
        wire(wires, effect, own[2 * n] if own else rngs[2 + 2 * n])
    raw = events_of(wires, scene, step_us, rngs[0])
    for n, effect in enumerate(effects):
        wires.fixed = own[2 * n + 1] if own else None
        raw = read_out(raw, effect, wires, rngs[3 + 2 * n])
    truth = {
        "base": asdict(base),
        "effects": [{**asdict(effect), "listed": effect.listed} for effect in effects],
        "patterns": wires.patterns,
        "film": {**asdict(film), "eight_bit": eight_bit, "fps": fps},
        "seconds": seconds,
        "seed": seed,
        "step_us": step_us,
        "scene": scene,
    }
    frames = exposed(scene, frame_t_us, film, eight_bit, rngs[1])
    stamps = _stamped(frame_t_us, effects)
    return Recorded(_packed(raw, seconds), frames, stamps, scene.width, scene.height, truth)


def _packed(raw: Floats, seconds: float) -> NDArray[Any]:
    raw = raw[(raw[:, 0] >= 0) & (raw[:, 0] < seconds * 1e6)]
    raw = raw[np.argsort(raw[:, 0], kind="stable")]
    events = np.empty(len(raw), EVENT)
    events["t"], events["x"], events["y"], events["p"] = raw[:, 0], raw[:, 1], raw[:, 2], raw[:, 3] > 0
    return events


def _stamped(frame_t_us: NDArray[np.int64], effects: Sequence[Effect]) -> NDArray[np.int64]:
    for effect in effects:
        if effect.name == "clock_offset":
            drift = 1e-6 * effect.parameters["ppm"] * frame_t_us
            frame_t_us = frame_t_us + np.round(effect.parameters["offset_us"] + drift).astype(np.int64)
    return frame_t_us


def shuffled_polarity(recording: Recorded, seed: int = 0) -> Recorded:
    """Sabotage: the same events, their polarities dealt out anew."""
    events = recording.events.copy()
    events["p"] = np.random.default_rng(seed).permutation(events["p"])
    return replace(recording, events=events, truth={**recording.truth, "sabotage": "shuffled polarity"})
