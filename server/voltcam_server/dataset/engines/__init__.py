"""Where items are made: processes of this machine, or a cluster that runs already."""

from .engine import Engine, EngineGoneError, Work
from .local import LocalEngine

__all__ = ["Engine", "EngineGoneError", "LocalEngine", "Work", "open_engine"]


def open_engine(address: str, workers: int) -> Engine:
    """address: "local", or dask://HOST:PORT of a scheduler. Raises UsageError."""
    if address == "local":
        return LocalEngine(workers)
    from .dask import DaskEngine

    return DaskEngine(address)
