"""`voltcam bench cuda`: a sensor on a GPU, its frames on the host or on the device. Figures are wall time."""

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from voltcam_simulator import Parameters, Simulator

from .figure import REPEATS, Figure
from .scene import moving

SIZES = {"640x480": (640, 480, 60), "1280x720": (1280, 720, 40), "4096x4096": (4096, 4096, 4)}  # frames
PERIOD_US = 4167
STAGES_OFF = {
    "latency": {"delay_us": 0.0, "jitter_us": 0.0}, "readout": {"row_us": 0.0, "event_us": 0.0},
    "hot_pixels": {"fraction": 0.0}, "noise_pairs": {"rate_hz": 0.0},
}  # fmt: skip


def cuda_steps() -> Iterator[Callable[[], list[Figure]]]:
    """What is measured, in order."""
    typical = Parameters.of("typical")
    models = {"base model": Parameters.of("paper"), "pixels of typical": typical.changed(STAGES_OFF)}
    for size, (width, height, count) in SIZES.items():
        for model, parameters in models.items():
            yield partial(cuda_speed, f"{size} {model}", parameters, width, height, count)


def cuda_speed(name: str, parameters: Parameters, width: int, height: int, count: int) -> list[Figure]:
    """Million pixels a second of a moving scene at 240 frames/s, events left where the frames are."""
    from voltcam_simulator.cuda.arrays import upload

    frames = moving(count, width, height)
    simulator = Simulator(width, height, parameters, seed=1, device="cuda")
    return [
        _rate(f"{name}, frames on the host", simulator, frames, simulator.advance, len),
        _rate(
            f"{name}, frames on the device", simulator, [upload(frame) for frame in frames],
            simulator.advance_on_device, _number,
        ),
    ]  # fmt: skip


def _rate(
    name: str, simulator: Simulator, frames: Any, advance: Callable[[Any, int], Any],
    number: Callable[[Any], int],
) -> Figure:  # fmt: skip
    """The first of the repeats compiles, and is left out."""
    t_us, rates, events = 0, [], 0
    pixels = (len(frames) - 1) * simulator.width * simulator.height
    for _ in range(REPEATS + 1):
        simulator.jump(frames[0], t_us)
        begin, events = time.perf_counter(), 0
        for frame in frames[1:]:
            t_us += PERIOD_US
            events += number(advance(frame, t_us))  # an interval's events have been counted, so it is done
        rates.append(pixels / (time.perf_counter() - begin) / 1e6)
        t_us += PERIOD_US
    return Figure.of(name, rates[1:], "Mpx/s", f"{events / pixels:.3f} events/pixel")


def _number(events: Any) -> int:
    return int(events.t.size)
