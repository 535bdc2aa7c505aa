"""`@kernel`: a plain function over arrays and scalars, compiled once and kept on disk.

Numba's cache notices an edit of the kernel's own file only, not of a file it calls into, so the
folder is named by a hash of all sources of this package: an edit anywhere recompiles.
"""

import fcntl
import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import caching, config

F = TypeVar("F", bound=Callable[..., object])
_FunctionCache: Any = caching.FunctionCache  # what Numba has for `cache=True`, of which it tells no types


def _cache_folder() -> Path:
    package = Path(__file__).parent
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(package.rglob("*.py")):
        digest.update(source.read_bytes())
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "voltcam" / f"kernels-{digest.hexdigest()[:16]}"


CACHE_FOLDER = _cache_folder()


def kernel(function: F) -> F:
    """Compile for speed: no Python objects inside, the interpreter lock released, cached on disk."""
    settings: Any = config  # its attributes are made at run time
    former = settings.CACHE_DIR
    settings.CACHE_DIR = str(CACHE_FOLDER)  # read at decoration; the caller's own setting stays
    try:
        compiled: Any = numba.njit(nogil=True, error_model="numpy")(function)
        cache: Any = _SharedCache  # numba says no types
        compiled._cache = cache(function)  # as `cache=True` sets it
    finally:
        settings.CACHE_DIR = former
    return cast(F, compiled)


class _SharedCache(_FunctionCache):  # type: ignore[misc]
    """Numba's cache, written by one process at a time.

    Its index is read, added to and written back. Of two processes that do so at once one loses its entry,
    and the other's entry may name a file with the machine code of another signature.
    """

    def save_overload(self, sig: object, data: object) -> None:
        folder = Path(self.cache_path)
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / "lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # let go when the file is closed, also by a kill
            super().save_overload(sig, data)
