"""How messages leave the daemon: one file per transport. A transport knows messages, and no physics."""

from .dv import DvTransport
from .foxglove import FoxgloveTransport
from .ros2 import Ros2Transport
from .transport import ClientStatus, Transport, TransportStatus
from .udp import UdpTransport
from .websocket import WebSocketTransport
from .zeromq import ZeroMQTransport

__all__ = [
    "ClientStatus",
    "DvTransport",
    "FoxgloveTransport",
    "Ros2Transport",
    "Transport",
    "TransportStatus",
    "UdpTransport",
    "WebSocketTransport",
    "ZeroMQTransport",
]
