"""`make ranges COUNT=n`: random legal changes of parameters on a simulator without a daemon around it.

A process of its own makes them. It fails when that process dies, when an interval takes longer than
PATIENCE_S, or when anything that later events depend on is no number. The parameters that did it are kept.
"""

import argparse
import faulthandler
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from voltcam_server.overload import OverloadSettings, coarser
from voltcam_simulator import Camera, GivenUpError, Limits, Parameters, Simulator

from .legal import Legal

WIDTH, HEIGHT, GAMMA = 64, 48, 2.2
MEMORY_BYTES = 6_000_000_000  # of address space
WORK_S = 0.3  # for an interval; then it is given up, as in a daemon that has 2 s
PATIENCE_S = 60.0  # kernels are compiled meanwhile
BURST = 20  # changes on top of each other; then all is put back
LIVES = 50  # bursts of one simulator, whose state goes on
SPANS_US, OFTEN = (17_000, 50_000, 200_000, 1_000_000), (0.6, 0.2, 0.1, 0.1)


def main() -> int:
    """Run the campaign; returns 1 where something was found."""
    parser = argparse.ArgumentParser(prog="make ranges", description=__doc__)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--inside", type=Path, help=argparse.SUPPRESS)  # what the process does
    arguments = parser.parse_args()
    if arguments.inside:
        return _changes(arguments.count, arguments.seed, arguments.inside)
    at = Path(tempfile.gettempdir()) / f"voltcam-ranges-{time.time_ns()}.json"
    command = [sys.executable, "-m", "tests.campaigns.ranges", "--inside", str(at)]
    command += ["--count", str(arguments.count), "--seed", str(arguments.seed)]
    code = subprocess.run(command, check=False).returncode
    if code:
        sys.stdout.write(f"FOUND: status {code}; the parameters are in {at}\n")
        return 1
    at.unlink(missing_ok=True)
    sys.stdout.write(f"{arguments.count} changes: nothing was found\n")
    return 0


def _changes(count: int, seed: int, at: Path) -> int:
    """In the process: change after change, each with an interval after it that the daemon would take."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    faulthandler.enable()
    legal, rng = Legal(Parameters.model_json_schema(), seed), np.random.default_rng([seed, 1])
    base = parameters = Camera.load("typical").parameters
    given_up = 0
    for done in tqdm(range(count), unit="change", mininterval=5):
        if done % (BURST * LIVES) == 0:
            simulator, t_us = Simulator(WIDTH, HEIGHT, base.seen_through(GAMMA), seed=done), 0
            simulator.advance(_frame(0), 0)
        if done % BURST == 0:
            parameters = base
        parameters = parameters.changed(legal.change())
        at.write_text(parameters.model_dump_json())
        span_us = int(rng.choice(SPANS_US, p=OFTEN))
        t_us += span_us
        faulthandler.dump_traceback_later(PATIENCE_S, exit=True)
        given_up += _interval(simulator, parameters, t_us, span_us)
        faulthandler.cancel_dump_traceback_later()
        if wrong := _no_numbers(simulator):
            sys.stdout.write(f"no number in {', '.join(wrong)} after {done + 1} changes\n")
            return 1
    sys.stdout.write(f"{given_up} of {count} intervals were given up\n")
    return 0


def _interval(simulator: Simulator, parameters: Parameters, t_us: int, span_us: int) -> bool:
    """As a daemon has it; says whether it was given up and jumped over."""
    bounds = OverloadSettings()
    end_s = time.monotonic() + WORK_S
    simulator.parameters = seen = parameters.seen_through(GAMMA)
    limits = Limits(
        coarser(span_us, seen.longest_step_us, WIDTH * HEIGHT),
        bounds.most_events,
        lambda: time.monotonic() > end_s,
    )
    try:
        simulator.advance(_frame(t_us), t_us, limits)
    except GivenUpError:
        simulator.jump(_frame(t_us), t_us)
        return True
    return False


def _frame(t_us: int) -> NDArray[np.uint8]:
    """Something that moves everywhere."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    t_s = t_us / 1e6
    return (127 + 100 * np.sin(x / 5 + 40 * t_s) * np.cos(y / 7 + 25 * t_s)).astype(np.uint8)


def _no_numbers(simulator: Simulator) -> list[str]:
    """Names of what has NaN in it, but for those where it says that there was no event before."""
    return [
        name
        for name, plane in simulator.snapshot().items()
        if plane.dtype.kind == "f" and np.isnan(plane).any() and not name.endswith("/before")
    ]


if __name__ == "__main__":
    sys.exit(main())
