"""Sockets that listen, and what is said where none can."""

import socket

import pytest

from voltcam_server.listening import address_of, listen
from voltcam_server.problems import UsageError


@pytest.mark.parametrize("host", ["127.0.0.1", "[::1]"])
def test_port_0_takes_a_free_one(host: str) -> None:
    with listen(f"{host}:0", "--here") as listener:
        address = address_of(listener)
        assert address.startswith(f"{host}:")
        port = int(address.rpartition(":")[2])
        with socket.create_connection((host.strip("[]"), port), 30):
            pass


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("127.0.0.1:65536", "no port is above 65535: give --here HOST:PORT"),
        ("no.such.host.invalid:1", "give --here HOST:PORT"),
        ("192.0.2.1:1", "end the program that has the port, or choose another with --here"),
    ],
)
def test_what_cannot_be_says_what_to_change(address: str, words: str) -> None:
    with pytest.raises(UsageError, match=words) as error:
        listen(address, "--here")
    assert address in str(error.value)
    assert "\n" not in str(error.value)
