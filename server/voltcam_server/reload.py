"""The settings read again while the daemon runs: what is the same goes on, subscribers and all."""

import threading
from collections.abc import Callable
from dataclasses import replace

from pydantic import BaseModel, ConfigDict

from voltcam_video import SourceError

from .camera_settings import CameraSettings
from .cameras import Cameras
from .plan import Plan, plans_of
from .problems import UsageError, one_line
from .running_camera import RunningCamera, Surroundings
from .settings import Settings

LIVE = {"source", "parameters", "camera"}  # what changes without an end of the stream


class ReloadAnswer(BaseModel):
    """Names of cameras, by what became of them."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    kept: list[str] = []
    """as they were"""

    changed: list[str] = []
    """while they run"""

    restarted: list[str] = []
    """anew, with other settings"""

    added: list[str] = []
    """new ones"""

    removed: list[str] = []
    """no longer there"""

    failed: dict[str, str] = {}
    """with the reason: they do not run, or not as the settings have it"""

    needs_restart: list[str] = []
    """settings of the daemon that hold from its next start on"""

    @property
    def words(self) -> str:
        """All that is new, on one line."""
        parts = [
            f"{key.replace('_', ' ')}: {', '.join(value)}"
            for key, value in self.model_dump().items()
            if value
        ]
        return "; ".join(parts)


class Reload:
    """Call it to read the settings again. settings: those that hold. read: raises UsageError."""

    def __init__(
        self, cameras: Cameras, around: Surroundings, settings: Settings, read: Callable[[], Settings]
    ) -> None:
        self._cameras, self._around, self._settings, self._read = cameras, around, settings, read
        self._one = threading.Lock()

    def __call__(self) -> ReloadAnswer:
        """Raises UsageError, with nothing changed."""
        if not self._one.acquire(blocking=False):
            raise UsageError("the settings are being read already: wait until that is done")
        try:
            settings = self._read()
            return self._apply(plans_of(settings), self._beyond_cameras(settings))
        finally:
            self._one.release()

    def _beyond_cameras(self, settings: Settings) -> list[str]:
        own = {*CameraSettings.model_fields, "cameras"}
        return [
            name
            for name in Settings.model_fields
            if name not in own and getattr(settings, name) != getattr(self._settings, name)
        ]

    def _apply(self, plans: list[Plan], needs_restart: list[str]) -> ReloadAnswer:
        answer = ReloadAnswer(needs_restart=needs_restart)
        wanted, former = {plan.name for plan in plans}, {camera.name: camera for camera in self._cameras}
        running = dict(former)
        for name in former.keys() - wanted:
            self._end(running, name)
            answer.removed.append(name)
        for plan in plans:
            try:
                getattr(answer, self._one_camera(running, plan)).append(plan.name)
            except (UsageError, SourceError) as error:
                answer.failed[plan.name] = one_line(error)
        self._cameras.replace(running[plan.name] for plan in plans if plan.name in running)
        return answer

    def _one_camera(self, running: dict[str, RunningCamera], plan: Plan) -> str:
        """Have it run as planned; returns what that took. Raises UsageError or SourceError."""
        camera = running.get(plan.name)
        if camera is None:
            self._begin(running, plan)
            return "added"
        if plan == camera.plan:
            return "kept"
        if _fixed(plan) == _fixed(camera.plan):
            running[plan.name] = self._changed(camera, plan)
            return "changed"
        self._end(running, plan.name)
        self._begin(running, plan)
        return "restarted"

    def _begin(self, running: dict[str, RunningCamera], plan: Plan) -> None:
        camera = RunningCamera.of(plan, self._around)
        try:
            camera.start()
        except UsageError:
            camera.stop()
            raise
        running[plan.name] = camera

    def _end(self, running: dict[str, RunningCamera], name: str) -> None:
        """Let nobody find it any more, then end it."""
        camera = running.pop(name)
        self._cameras.replace(each for each in self._cameras if each is not camera)
        camera.stop()

    @staticmethod
    def _changed(camera: RunningCamera, plan: Plan) -> RunningCamera:
        if plan.settings.source != camera.plan.settings.source:
            camera.emulator.look_at(plan.settings.source)
        if plan.camera.parameters != camera.plan.camera.parameters:
            simulation = camera.emulator.simulation
            simulation.prepare(plan.camera.parameters)
            simulation.change(plan.camera.parameters.model_dump())
        return replace(camera, plan=plan)


def _fixed(plan: Plan) -> object:
    """What a camera is ended for, where it changes."""
    return plan.settings.model_dump(exclude=LIVE), plan.camera.model_dump(exclude={"parameters"})
