"""A program of others in a process of its own, that says a line when it is ready and saves what came."""

import subprocess
import sys
from pathlib import Path
from typing import Self

import numpy as np

from ..rig import PATIENCE_S


class OtherProgram:
    """`program` of this folder, with arguments; `said`: its first line. A context manager that ends it."""

    def __init__(self, program: str, *arguments: str, file: Path) -> None:
        self.file = file
        path = str(Path(__file__).with_name(program))
        self.process = subprocess.Popen([sys.executable, path, *arguments], stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.said = self.process.stdout.readline().strip()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()

    def result(self) -> dict[str, np.ndarray]:
        """The arrays that it has saved in its file, once it has ended."""
        self.process.communicate(timeout=2 * PATIENCE_S)
        with np.load(self.file) as arrays:
            return dict(arrays)
