"""A process that makes items works in one thread: there are as many processes as cores."""

import os
from functools import cache

from voltcam_video import use_one_thread

ONE_THREAD = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "BLOSC_NTHREADS")
"""What libraries read when they are loaded; what Blosc writes would also depend on it."""


@cache
def use_one_thread_here() -> None:
    """In this process, as far as its libraries still let it."""
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    use_one_thread()
