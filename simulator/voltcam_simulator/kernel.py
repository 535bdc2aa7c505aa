"""`@kernel`: a plain function over arrays and scalars, compiled once and kept on disk.

Numba's cache notices an edit of the kernel's own file only, not of a file it calls into. So all that is kept
is marked with a hash of all sources of this package: an edit anywhere recompiles.
"""

import fcntl
import functools
import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import caching, config

from .processor import best_target

F = TypeVar("F", bound=Callable[..., object])
_numba: Any = caching  # of what it has for `cache=True` it tells no types
_FunctionCache: Any = _numba.FunctionCache
_Implementation: Any = _numba.CompileResultCacheImpl
_Locator: Any = _numba._CacheLocator

PACKAGE = Path(__file__).parent
COMPILED = PACKAGE / "compiled"
"""Kernels that came with the package, a folder for each target; `ahead` makes them."""


def _cache_folder() -> Path:
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(PACKAGE.rglob("*.py")):
        digest.update(source.read_bytes())
    try:
        root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    except RuntimeError:  # there is no home
        root = os.devnull  # no folder can be made there, so nothing is kept
    return Path(root) / "voltcam" / f"kernels-{digest.hexdigest()[:16]}"


CACHE_FOLDER = _cache_folder()


def kernel(function: F) -> F:
    """Compile for speed: no Python objects inside, the interpreter lock released, cached on disk."""
    njit: Any = numba.njit  # its types leave out the last of these: no entry for C, a twentieth of the work
    compiled = njit(nogil=True, error_model="numpy", no_cfunc_wrapper=True)(function)
    cache: Any = _Cache  # numba says no types
    compiled._cache = cache(function)  # as `cache=True` sets it
    return cast(F, compiled)


@functools.cache
def _digest(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


class _OwnFolder(_Locator):  # type: ignore[misc]
    """Where Numba's cache keeps a function: in CACHE_FOLDER, whether it can be written to or not."""

    def __init__(self, function: Any, file: str) -> None:
        self._py_file, self._line = file, function.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        return str(CACHE_FOLDER / self.get_suitable_cache_subpath(self._py_file))

    def get_source_stamp(self) -> object:
        return CACHE_FOLDER.name, _digest(self._py_file)

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, function: Any, file: str) -> "_OwnFolder":
        return cls(function, file)


class _OwnImplementation(_Implementation):  # type: ignore[misc]
    _locator_classes = [_OwnFolder]  # noqa: RUF012, it is Numba's


class _Cache(_FunctionCache):  # type: ignore[misc]
    """Numba's cache, written by one process at a time, and with what came with the package behind it."""

    _impl_class = _OwnImplementation

    def load_overload(self, sig: object, target_context: Any) -> Any:
        with suppress(OSError):  # a folder that is not ours to read
            if (own := super().load_overload(sig, target_context)) is not None:
                return own
        return self._from_package(sig, target_context)

    def save_overload(self, sig: object, data: object) -> None:
        """Keep it; where nothing can be written, it is compiled once in each process.

        The index is read, added to and written back. Of two processes that do so at once one loses its entry,
        and the other's entry may name a file with the machine code of another signature.
        """
        folder = Path(self.cache_path)
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            with (folder / "lock").open("w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)  # let go when the file is closed, also by a kill
                super().save_overload(sig, data)

    def _from_package(self, sig: object, target_context: Any) -> Any:
        """This kernel as it came with the package, where it is of these sources and for such a processor."""
        settings: Any = config
        if not self._py_func.__module__.startswith(f"{__package__}.") or settings.USING_SVML:
            return None  # SVML has other logarithms, and those on one machine are to be the same
        signature, (triple, _, features), code = self._index_key(sig, target_context.codegen())
        target = best_target(features) if settings.CPU_NAME is None else None
        if target is None:
            return None
        stamp, base = self._impl.locator.get_source_stamp(), self._impl.filename_base
        file = _numba.IndexDataCacheFile(str(COMPILED / target.name), base, stamp)
        with suppress(OSError):
            data = file.load((signature, (triple, target.name, target.features), code))
            return None if data is None else self._impl.rebuild(target_context, data)
        return None
