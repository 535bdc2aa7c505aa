"""Sockets that listen where the settings say, or an error that says what to change."""

import socket

from .problems import UsageError


def listen(address: str, option: str) -> socket.socket:
    """A listening TCP socket on HOST:PORT. Raises UsageError, which names the option to change."""
    host, _, port = address.rpartition(":")
    if int(port) > 65535:  # which getaddrinfo would take modulo 65536
        raise UsageError(f"{address}: no port is above 65535: give {option} HOST:PORT")
    try:
        family, kind, proto, _, sockaddr = socket.getaddrinfo(
            host.strip("[]"), int(port), type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listener = socket.socket(family, kind, proto)
    except (OSError, OverflowError) as error:
        raise UsageError(f"{address}: {getattr(error, 'strerror', error)}: give {option} HOST:PORT") from None
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(sockaddr)
        listener.listen(128)
    except (OSError, OverflowError) as error:
        listener.close()
        reason = getattr(error, "strerror", None) or error
        raise UsageError(
            f"{address}: {reason}: end the program that has the port, or choose another with {option}"
        ) from None
    return listener


def address_of(listener: socket.socket) -> str:
    """HOST:PORT."""
    host, port = listener.getsockname()[:2]
    return f"[{host}]:{port}" if listener.family == socket.AF_INET6 else f"{host}:{port}"
