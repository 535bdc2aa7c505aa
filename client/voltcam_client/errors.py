"""What this package raises. Every message is one line that names the thing and the remedy."""


class VoltcamError(ValueError):
    """Base of the errors below, for ``except VoltcamError``."""


class PacketError(VoltcamError):
    """Events that do not fit an encoding, or bytes that are not a Voltcam message."""


class ControlError(VoltcamError):
    """The daemon refused a request (`status` is the HTTP status), or cannot be reached (None)."""

    def __init__(self, message: str, status: int | None = None) -> None:
        super().__init__(message)
        self.status = status
