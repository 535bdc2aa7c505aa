"""Kernels compiled ahead, for a wheel or an image: `python -m voltcam_simulator.ahead` makes `compiled/`.

They serve the Python, Numba and sources that they were made with; others compile as though there were none.
"""

import os
import pickle
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any, get_args

import numpy as np
from numba.core import config
from numba.core.dispatcher import Dispatcher

from . import Law, Parameters, Simulator, camera_names
from .kernel import COMPILED
from .processor import TARGETS, Target

IN_NO_CAMERA = Parameters().changed({"residual_kick": {"after_on": 0.1}})
"""What compiles so long (16 s) that a daemon would miss frames."""
STILL_FRAMES, STILL_US = 20, 500_000  # still so long that rows are drawn ahead, and their clock begins anew
SUDDEN_US = 100  # in which all pixels fire: events so dense are sorted in another way
WIDTH, HEIGHT = 40, 30  # pixels that together have more events than a library sorts faster
LIMIT_S = 600  # for one target, which takes 13
Signature = tuple[str, str, Any]
"""Module and name of a kernel, and Numba's types of its arguments."""


def main() -> None:
    """Make `compiled` anew; on other processors than x86-64 there is nothing to make."""
    shutil.rmtree(COMPILED, ignore_errors=True)
    settings: Any = config
    if settings.USING_SVML:
        sys.exit("Numba uses Intel's SVML, which users may not have: uninstall icc_rt, intel-cmplr-lib-rt")
    if platform.machine() != "x86_64":
        print(f"kernels are compiled ahead for x86-64 only, and this is {platform.machine()}")  # noqa: T201
        return
    signatures = used_signatures()
    for target in TARGETS:
        compile_for(target, signatures, COMPILED / target.name)


def used_signatures() -> list[Signature]:
    """What the cameras of the package need, under both laws, for frames of bytes and of floats, of light and
    coded for screens, and `IN_NO_CAMERA`."""
    needs = [*map(Parameters.of, camera_names()), IN_NO_CAMERA]
    for parameters, law, dtype, gamma in product(needs, get_args(Law), (np.uint8, np.float32), (1.0, 2.2)):
        coded = parameters.changed({"input_response": {"gamma_exponent": gamma}})
        simulator, dark = Simulator(WIDTH, HEIGHT, coded, law, seed=1), np.full((HEIGHT, WIDTH), 20, dtype)
        for i in range(1 + STILL_FRAMES):  # dark, then bright, at last dark at once
            simulator.advance(np.full_like(dark, 200) if i else dark, i * STILL_US)
        simulator.advance(dark, STILL_FRAMES * STILL_US + SUDDEN_US)
    return [(k.py_func.__module__, k.__name__, types) for k in _kernels() for types in k.overloads]


def _kernels() -> Iterator[Any]:
    """All kernels of this package, each in its own module."""
    for name, module in list(sys.modules.items()):
        if name.startswith(f"{__package__}."):
            for found in vars(module).values():
                if isinstance(found, Dispatcher) and found.py_func.__module__ == name:
                    yield found


def compile_for(target: Target, signatures: list[Signature], folder: Path) -> None:
    """Compile kernels for a target, which this machine need not be, into a folder of their own."""
    with tempfile.TemporaryDirectory() as cache:
        own = {"NUMBA_CPU_NAME": target.name, "NUMBA_CPU_FEATURES": target.features, "XDG_CACHE_HOME": cache}
        subprocess.run(
            [sys.executable, "-c", f"from {__package__}.ahead import _compile; _compile()"],
            input=pickle.dumps(signatures),
            env=os.environ | own,
            check=True,
            timeout=LIMIT_S,
        )
        folder.mkdir(parents=True)
        for file in Path(cache).rglob("*.nb[ci]"):
            if (folder / file.name).exists():
                raise RuntimeError(
                    f"two kernels would be kept as {file.name}: rename one of them or its module"
                )
            shutil.copy(file, folder)


def _compile() -> None:
    """In the process for a target. No kernel is run: it may have instructions that this machine has not."""
    for module, name, types in pickle.load(sys.stdin.buffer):
        getattr(import_module(module), name).compile(types)


if __name__ == "__main__":
    main()
