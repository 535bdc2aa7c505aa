"""Kernels for the device in which a product and a sum are rounded one after the other, as on a processor.

By itself the device's compiler makes one operation of both (FMA), rounded once: other last bits, and so, now
and then, another event. numba-cuda has no option for it; NVVM, which it hands the code to, has.
"""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from typing import Any

_ours: ContextVar[bool] = ContextVar("ours", default=False)


@contextmanager
def unfused() -> Iterator[None]:
    """What numba-cuda compiles in here is compiled so."""
    token = _ours.set(True)
    try:
        yield
    finally:
        _ours.reset(token)


def install() -> None:
    """Once for the process; kernels of others are compiled as before."""
    with suppress(ImportError):  # the simulator has no NVVM
        from numba.cuda.cudadrv import nvvm

        module: Any = nvvm
        former = getattr(module, "compile_ir", None)
        if former is None or getattr(former, "asks_voltcam", False):
            return

        def compile_ir(llvmir: Any, **options: Any) -> Any:
            if _ours.get():
                options["fma"] = False
            return former(llvmir, **options)

        compile_ir.asks_voltcam = True  # type: ignore[attr-defined]
        module.compile_ir = compile_ir
