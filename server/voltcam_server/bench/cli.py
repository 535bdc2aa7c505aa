"""`voltcam bench`: frames in memory to time-sorted packed events, beside the machine's own limits.

Every figure is CPU time of one thread unless it says otherwise: median over repeats, with the least and most.
"""

import logging
import os
import subprocess
import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from pathlib import Path
from statistics import median

import numpy as np
from tqdm import tqdm

from voltcam_simulator import Law, NoDeviceError, Parameters, Simulator
from voltcam_video import Frame, along_flow
from voltcam_video.sources.scene import render

from ..problems import UsageError
from .cuda import cuda_steps
from .figure import REPEATS, Figure, Frames, repeated
from .limits import MachineLimits, numpy_paper_law
from .live import live
from .report import BenchReport
from .scene import moving, noisy
from .senders import left_out
from .transports import transports

STILL_FRAMES = 600  # twenty seconds: long enough for the start, eight frames and a draw, to be a small part
SIZES = {"346x260": (346, 260, 60), "1280x720": (1280, 720, 12)}  # width, height, frames


def configure(parser: ArgumentParser) -> None:
    """The command line of `voltcam bench`."""
    parser.add_argument(
        "what",
        nargs="?",
        choices=("all", "transports", "cuda"),
        default="all",
        help="transports: only how fast events reach another process, beside a plain socket; 80 seconds."
        " cuda: only a sensor on a GPU; 2 minutes",
    )
    parser.add_argument("--json", action="store_true", help="print the figures as JSON, to be compared later")
    parser.add_argument(
        "--compare", type=Path, metavar="OLD.json", help="hold the figures against those of an older run"
    )
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> int:
    """Measure everything and print it; the bar goes to standard error."""
    old = BenchReport.read(arguments.compare) if arguments.compare else None
    figures: list[Figure] = []
    if arguments.what == "transports":
        # Transports tell of what the bench does to them: receivers that are killed, times that begin at 0.
        logging.getLogger().addHandler(logging.NullHandler())
        steps = list(transports())
        sys.stderr.writelines(f"{line}\n" for line in left_out())
    elif arguments.what == "cuda":
        steps = list(cuda_steps())
    else:
        limits = MachineLimits.measured()
        figures, steps = list(limits.figures), list(plan(limits))
    for measure in tqdm(steps, desc="voltcam bench", disable=None, leave=False):
        try:
            found = measure()
        except NoDeviceError as error:
            raise UsageError(str(error)) from None
        figures += found
        if not (arguments.json or old):
            tqdm.write("\n".join(map(str, found)))
    report = BenchReport.of(figures)
    if arguments.json:
        sys.stdout.write(report.to_json())
    if old:
        (sys.stderr if arguments.json else sys.stdout).write(report.against(old) + "\n")
    return 0


def plan(limits: MachineLimits) -> Iterator[Callable[[], list[Figure]]]:
    """What is measured, in order."""
    base, camera = Parameters.of("paper"), Parameters.of("typical")
    pace = partial(speed, limits)
    for size, (width, height, count) in SIZES.items():
        scene = moving(count, width, height)
        still = np.broadcast_to(scene[0], (STILL_FRAMES, height, width))
        webcam = noisy(count, width, height)
        yield partial(pace, f"{size} moving, base model, exact law", scene, 240, base)
        yield partial(pace, f"{size} static, base model, exact law", still, 30, base)
        yield partial(pace, f"{size} noise of 2 DN, base model, exact law", webcam, 30, base)
        for fps in (240, 60, 30):
            yield partial(pace, f"{size} moving, typical, {fps} frames/s", scene, fps, camera)
        yield partial(pace, f"{size} moving, base model, paper law", scene, 240, base, "paper")
        for model, parameters in (("base model", base), ("typical", camera)):
            yield partial(two_threads, f"{size} {model}, two threads over one, wall time", scene, parameters)
    scene = moving(60, 346, 260)
    yield partial(numpy_paper_law, scene[:6])
    yield partial(cost_per_event, scene, base)
    yield partial(upsampling, moving(61, 346, 260)[::4])
    yield partial(memory, base)
    yield live
    yield start


def speed(
    limits: MachineLimits, name: str, frames: Frames, fps: float, parameters: Parameters, law: Law = "exact"
) -> list[Figure]:
    """Million pixels a CPU second, the events that made, and how far it is from the machine's limit: frames
    and state read and written once a frame, and the events sorted."""
    seconds, events = timed(frames, fps, parameters, law)
    pixels, (height, width) = frames[1:].size, frames[0].shape
    state_bytes = Simulator(width, height, parameters, law).state_bytes * len(frames[1:])
    least_s = limits.seconds(state_bytes + pixels, events)
    remark = f"{events / pixels:.3f} events/pixel, {median(seconds) / least_s:.1f} times the limit"
    return [Figure.of(name, [pixels / s / 1e6 for s in seconds], "Mpx/s", remark)]


def timed(
    frames: Frames, fps: float, parameters: Parameters, law: Law = "exact", threads: int = 1,
    clock: Callable[[], float] = time.process_time,
) -> tuple[list[float], float]:  # fmt: skip
    """(seconds of each repeat over frames[1:], events of one); the first, which warms up, is left out."""
    height, width = frames[0].shape
    simulator = Simulator(width, height, parameters, law, seed=1, threads=threads)
    period_us, t_us = round(1e6 / fps), 0
    seconds, events = [], 0
    for _ in range(REPEATS + 1):
        simulator.jump(frames[0], t_us)
        begin, times = clock(), range(t_us + period_us, t_us + period_us * len(frames), period_us)
        events = sum(map(len, simulator.stream(zip(frames[1:], times, strict=True))))
        seconds.append(clock() - begin)
        t_us += period_us * len(frames)
    return seconds[1:], events


def two_threads(name: str, frames: Frames, parameters: Parameters) -> list[Figure]:
    """Wall time of one thread over that of two."""
    one, _ = timed(frames, 240, parameters, clock=time.perf_counter)
    two, _ = timed(frames, 240, parameters, threads=2, clock=time.perf_counter)
    return [
        Figure.of(name, [a / b for a, b in zip(one, two, strict=True)], "times", f"{os.cpu_count()} cores")
    ]


def cost_per_event(frames: Frames, parameters: Parameters) -> list[Figure]:
    """Time that one more event costs, sorted and packed: by the same scene with thresholds doubled."""
    many, more = timed(frames, 240, parameters)
    few, less = timed(frames, 240, parameters.changed({"comparator": {"theta_on": 2, "theta_off": 2}}))
    costs = [(a - b) / (more - less) * 1e9 for a, b in zip(sorted(many), sorted(few), strict=True)]
    return [Figure.of("cost of an event, sorted and packed", costs, "ns")]


def upsampling(frames: Frames) -> list[Figure]:
    """CPU time for the frames between two that are 6 pixels apart, and for a frame of the built-in scene."""
    pairs = [(Frame(a, 0), Frame(b, 33_333)) for a, b in pairwise(frames)]
    figures = []
    for name, action in (
        ("346x260 frames between frames, auto", [partial(_follow, *pair) for pair in pairs]),
        ("346x260 built-in scene, a frame", [partial(render, 16_667 * i) for i in range(len(pairs))]),
    ):
        action[0]()
        seconds = [repeated(step, 1, time.process_time)[0] * 1e3 for step in action]
        figures.append(Figure.of(name, seconds, "ms"))
    return figures


def _follow(former: Frame, frame: Frame) -> int:
    return len(list(along_flow(former, frame)))


def memory(parameters: Parameters) -> list[Figure]:
    """Bytes of state for each pixel, and what five hundred more frames add to state and events."""
    figures = []
    for size, (width, height, _) in SIZES.items():
        frames = moving(6, width, height)
        simulator = Simulator(width, height, parameters, seed=1)
        sizes = []
        for i in range(1000 if width < 1000 else 20):
            simulator.advance(frames[i % 6], (i + 1) * 4000)
            sizes.append(float(simulator.state_bytes + simulator.event_bytes))
        figures.append(
            Figure.of(f"{size} state, base model", [simulator.state_bytes / frames[0].size], "bytes/pixel")
        )
        if width < 1000:
            figures.append(
                Figure.of(f"{size} growth from frame 500 to 1000", [sizes[-1] - sizes[499]], "bytes")
            )
    return figures


def start() -> list[Figure]:
    """From process start to the first events, for a new user and for one who has been here before."""
    program = (
        "import numpy as np; from voltcam_simulator import Parameters, Simulator\n"
        "s = Simulator(346, 260, Parameters.of('paper'))\n"
        "s.advance(np.zeros((260, 346), np.uint8), 0)\n"
        "assert len(s.advance(np.full((260, 346), 255, np.uint8), 10000))"
    )
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        for name, repeats in (("cold", 1), ("warm", 3)):
            command = [sys.executable, "-c", program]
            environment = os.environ | {"XDG_CACHE_HOME": folder}
            seconds = repeated(lambda: subprocess.run(command, check=True, env=environment), repeats)  # noqa: B023
            compiled = len(list(Path(folder).rglob("*.nbc")))
            remark = f"{compiled} kernels compiled here" if compiled else "all kernels compiled ahead"
            figures.append(
                Figure.of(f"process start to first events, {name} compile cache", seconds, "s", remark)
            )
    return figures
