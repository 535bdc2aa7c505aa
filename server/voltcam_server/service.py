"""What systemd is told of a service of `Type=notify`: that it is ready, that it lives, that it ends."""

import os
import socket


def tell_systemd(words: str) -> None:
    """Send READY=1, WATCHDOG=1, STOPPING=1 or STATUS=...; does nothing where nobody asked (sd_notify(3))."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address:
        return
    if address.startswith("@"):
        address = "\0" + address[1:]
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as channel:
        try:
            channel.sendto(words.encode(), address)
        except OSError:
            return  # systemd has gone away, or is being started again
