"""Which sources may be asked for over REST. What the operator names in settings is not held to this."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from urllib.parse import urlsplit

from voltcam_video import SourceRequest
from voltcam_video.request import PHOTOS

from ..replay_source import SCHEME
from .paths import AccessError, resolve_under
from .settings import AccessSettings


class SourceRules:
    """Held against the settings of access."""

    def __init__(self, settings: AccessSettings) -> None:
        self._settings = settings

    def allowed(self, request: SourceRequest, own: str) -> SourceRequest:
        """The request, with the path of a file resolved. Raises AccessError.

        own: the source of the camera's settings, which may always be asked for again.
        """
        uri = request.uri
        if uri in (own, "scene") or request.shown == own:
            return request
        if request.device is not None:
            self._check(request.device, self._settings.source_devices, "source_devices")
            return request
        if uri.startswith(SCHEME):
            return request.model_copy(update={"uri": f"{SCHEME}{self.path(uri.removeprefix(SCHEME))}"})
        if request.photo_folder is not None:
            options = f"?{request.photo_options}" if request.photo_options else ""
            return request.model_copy(
                update={"uri": f"{PHOTOS}{self.path(str(request.photo_folder))}{options}"}
            )
        if "://" in uri or urlsplit_scheme(uri):
            self._check(uri, self._settings.source_urls, "source_urls")
            return request
        return request.model_copy(update={"uri": str(self.path(uri))})

    def path(self, name: str) -> Path:
        """A recording's path. Raises AccessError."""
        path = resolve_under(self._settings.source_folders, name)
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise AccessError(f"{name[:80]!r} is neither a file nor a folder")
        return path

    def stream(self, address: str) -> str:
        """The ZeroMQ address of another camera, for a diagnosis. Raises AccessError."""
        self._check(address, self._settings.streams, "streams")
        return address

    @staticmethod
    def _check(wanted: str, patterns: Sequence[str], setting: str) -> None:
        # The host must not be what a pattern's star has swallowed, as in rtsp://good.local@evil/.
        plain = "@" not in urlsplit(wanted).netloc
        if not any((plain or "@" in pattern) and fnmatchcase(wanted, pattern) for pattern in patterns):
            raise AccessError(
                f"{wanted[:80]!r} is not open to the network: its operator can add it to access.{setting}"
            )


def urlsplit_scheme(uri: str) -> bool:
    """Whether OpenCV or FFmpeg may take this for a protocol of theirs, such as concat:a|b or file:x."""
    head, colon, _ = uri.partition(":")
    return bool(colon) and "/" not in head
