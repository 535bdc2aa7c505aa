"""The cameras of a daemon, and how they are together."""

from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor

from .running_camera import RunningCamera
from .status import State

WORST_FIRST: tuple[State, ...] = ("stalled", "source lost", "starting", "ended", "overloaded", "running")


class NoCameraError(ValueError):
    """There is no camera of that name."""


class Cameras:
    """Those that run, in the order of the settings. The first is meant where none is named."""

    def __init__(self, running: Iterable[RunningCamera] = ()) -> None:
        self._running = tuple(running)  # replaced, never changed: any thread may go through it

    def __iter__(self) -> Iterator[RunningCamera]:
        return iter(self._running)

    def get(self, name: str | None = None) -> RunningCamera:
        """A camera by name. Raises NoCameraError."""
        for camera in self._running:
            if name in (None, camera.name):
                return camera
        names = ", ".join(camera.name for camera in self._running)
        raise NoCameraError(
            f"there is no camera {name!r}, only {names or 'none'}: GET /api/v1/cameras lists them"
        )

    def replace(self, running: Iterable[RunningCamera]) -> None:
        """These, and no others."""
        self._running = tuple(running)

    @property
    def state(self) -> tuple[State, str]:
        """That of the camera which is worst, with its name in the reason where there are several."""
        states = [(*camera.emulator.state, camera.name) for camera in self]
        if not states:
            return "starting", "no camera runs"
        state, reason, name = min(states, key=lambda each: WORST_FIRST.index(each[0]))
        return state, f"{name}: {reason}" if len(states) > 1 and reason else reason

    @property
    def failure(self) -> Exception | None:
        """An error of ours that has ended a thread."""
        return next((camera.emulator.failure for camera in self if camera.emulator.failure), None)

    @property
    def busy(self) -> bool:
        """After `stop`: whether something goes on that cannot be ended."""
        return any(camera.emulator.busy for camera in self)

    def start(self) -> None:
        """Start all of them, at the same time. Raises UsageError of the first that cannot."""
        with ThreadPoolExecutor(max(1, len(self._running))) as pool:
            list(pool.map(RunningCamera.start, self._running))

    def stop(self) -> None:
        """End all of them, at the same time."""
        with ThreadPoolExecutor(max(1, len(self._running))) as pool:
            list(pool.map(RunningCamera.stop, self._running))
