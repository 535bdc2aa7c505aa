"""Telling the local network where the cameras are: multicast DNS, a service `_voltcam._tcp` for each."""

import contextlib
import ipaddress
import socket
from collections.abc import Iterator, Mapping
from importlib.metadata import version

from .problems import UsageError

KIND = "_voltcam._tcp.local."


@contextlib.contextmanager
def announced(listener: socket.socket, secure: bool, cameras: Mapping[str, str]) -> Iterator[None]:
    """Inside, cameras can be found, by name with their ZeroMQ endpoints, where the listener can be reached.

    Raises UsageError without the extra `announce`, or where the network takes no multicast.
    """
    try:
        from ifaddr import get_adapters
        from zeroconf import NonUniqueNameException, ServiceInfo, Zeroconf
    except ImportError as error:
        raise UsageError(f"announce: needs pip install 'voltcam[announce]' ({error})") from None
    host, port = listener.getsockname()[:2]
    bound = ipaddress.ip_address(host.partition("%")[0])
    addresses = [host]
    if bound.is_unspecified:
        addresses = [ip.ip for each in get_adapters() for ip in each.ips if isinstance(ip.ip, str)]
    services = [
        ServiceInfo(
            KIND,
            f"{name} on {socket.gethostname()}.{KIND}",
            parsed_addresses=addresses,
            port=port,
            properties={
                "camera": name,
                "zmq": endpoint.rpartition(":")[2],
                "https": str(int(secure)),
                "version": version("voltcam"),
            },
        )
        for name, endpoint in cameras.items()
    ]
    try:
        network = Zeroconf(interfaces=addresses)
    except OSError as error:
        raise UsageError(f"announce: {error}: leave it out, or see whether multicast works") from None
    with contextlib.closing(network):
        try:
            for service in services:
                network.register_service(service, allow_name_change=True)
        except (OSError, NonUniqueNameException) as error:
            raise UsageError(f"announce: {error}: leave it out") from None
        yield
        network.unregister_all_services()
