"""Which step a long command is at: a bar on a terminal, a line each where output goes to a file."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tqdm import tqdm

Step = Callable[[str], None]


@contextmanager
def told_steps(bar_format: str, total: int | None = None) -> Iterator[Step]:
    """What to call with the name of each step as it begins; bar and lines go to standard error.

    total: how many steps there are, where that is known. Steps of one name in a row are one line.
    """
    begun_s, latest = time.monotonic(), ""
    with tqdm(total=total, disable=None, leave=False, bar_format=bar_format) as bar:

        def step(name: str) -> None:
            nonlocal latest
            bar.set_description_str(name)
            bar.update()
            if bar.disable and name != latest:
                sys.stderr.write(f"voltcam: {time.monotonic() - begun_s:.0f} s: {name}\n")
                sys.stderr.flush()
            latest = name

        yield step
