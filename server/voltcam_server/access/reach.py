"""From where the daemon can be reached: beyond this machine only by those who may."""

import ipaddress
import socket
from typing import TYPE_CHECKING

from voltcam_client.ros2 import Ros2Error
from voltcam_client.ros2.names import Ros2Place

from ..problems import UsageError
from .tokens import Tokens

if TYPE_CHECKING:
    from ..settings import Settings


def host_of(address: str) -> str:
    """The host of HOST:PORT."""
    return address.rpartition(":")[0].strip("[]")


def check_reach(settings: "Settings", tokens: Tokens) -> None:
    """Refuse to start where anyone could come. Raises UsageError with the remedy."""
    access = settings.access
    if (access.tls_certificate is None) != (access.tls_key is None):
        raise UsageError("https needs both access.tls_certificate and access.tls_key")
    if access.open:
        return
    if not _is_loopback(host_of(settings.http)) and not tokens:
        raise UsageError(
            f"--http {settings.http} is open to the network, and there is no token: set VOLTCAM_TOKEN to one "
            "made with `openssl rand -hex 32`, or access.tokens_file in the config file, or stay on 127.0.0.1"
        )
    for camera in settings.each().values():
        inlet = camera.source.inlet
        if inlet is not None and not _is_loopback(host_of(inlet.removeprefix("tcp://"))):
            raise UsageError(
                f"--source {camera.source.shown} is open to the network, and anyone could send frames: use "
                "127.0.0.1, and reach it from elsewhere with `ssh -L 5570:127.0.0.1:5570 HOST`"
            )
        tcp = camera.zmq.startswith("tcp://")
        if tcp and not _is_loopback(host_of(camera.zmq.removeprefix("tcp://"))) and access.curve_keys is None:
            raise UsageError(
                f"--zmq {camera.zmq} is open to the network, and there are no keys: make some with "
                "`voltcam keys`, name their folder as access.curve_keys in the config, or stay on 127.0.0.1"
            )
        if camera.dv != "off" and not _is_loopback(host_of(camera.dv)):
            raise UsageError(
                f"--dv {camera.dv} is open to the network, and DV's protocol has no keys: stay on 127.0.0.1, "
                "to which an ssh tunnel leads, or say access.open in the config"
            )
        if camera.foxglove != "off" and not _is_loopback(host_of(camera.foxglove)):
            raise UsageError(
                f"--foxglove {camera.foxglove} is open to the network, and it asks for no token: stay on "
                "127.0.0.1, to which an ssh tunnel leads, or say access.open in the config"
            )
        if camera.source.ros2_topic is not None:
            _check_ros2(f"--source {camera.source.shown}")
        if camera.ros2 != "off":
            _check_ros2(f"--ros2 {camera.ros2}")


def _check_ros2(asked: str) -> None:
    """Raises UsageError where ROS 2's topics go beyond this machine."""
    try:
        subnet = Ros2Place.of().subnet
    except Ros2Error as error:
        raise UsageError(f"{asked}: {error}") from None
    if subnet:
        raise UsageError(
            f"{asked} is open to the network by ROS_AUTOMATIC_DISCOVERY_RANGE, and anyone could join: set it "
            "to LOCALHOST, or say access.open in the config"
        )


def _is_loopback(host: str) -> bool:
    """Whether only this machine reaches what is bound to a host; a name counts as all its addresses."""
    try:
        return ipaddress.ip_address(host.partition("%")[0]).is_loopback
    except ValueError:
        pass
    try:
        found = socket.getaddrinfo(host, None)
    except OSError:
        return False
    return all(ipaddress.ip_address(str(info[4][0]).partition("%")[0]).is_loopback for info in found)
