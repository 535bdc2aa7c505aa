"""How messages leave the daemon: one file per transport. A transport knows messages, and no physics."""

from .dv import DvTransport
from .ros2 import Ros2Transport
from .transport import ClientStatus, Transport, TransportStatus
from .websocket import WebSocketTransport
from .zeromq import ZeroMQTransport

__all__ = [
    "ClientStatus",
    "DvTransport",
    "Ros2Transport",
    "Transport",
    "TransportStatus",
    "WebSocketTransport",
    "ZeroMQTransport",
]
