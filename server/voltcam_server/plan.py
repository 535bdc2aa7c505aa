"""What cameras are to run, as the settings have it."""

from dataclasses import dataclass

from voltcam_simulator import Camera

from .camera_settings import CameraSettings, check_encoding
from .problems import UsageError
from .settings import Settings

SERIAL = "EMU00001"


@dataclass(frozen=True)
class Plan:
    """A camera as the settings have it, its file read. serial: by which DV's programs know it."""

    name: str
    settings: CameraSettings
    camera: Camera
    serial: str = SERIAL


def plans_of(settings: Settings) -> list[Plan]:
    """What is to run. Raises UsageError for a camera file, or an encoding, that cannot be."""
    plans = []
    for name, each in settings.each().items():
        try:
            camera = each.load_camera()
            check_encoding(each.encoding, camera.width, camera.height)
        except UsageError as error:
            raise UsageError(f"cameras.{name}: {error}" if settings.cameras else str(error)) from None
        if settings.cameras:
            camera = camera.model_copy(update={"name": name})
        plans.append(Plan(camera.name, each, camera, name if settings.cameras else SERIAL))
    return plans
