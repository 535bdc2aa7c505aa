"""Keys of CURVE, ZeroMQ's encryption: who has none that a camera knows hears nothing from it.

A camera's folder has its own pair and `clients`, the public keys of those who may listen. A client's folder
has its own pair and the camera's public key, `camera.key`.
"""

import shutil
from pathlib import Path

import zmq
import zmq.auth

from voltcam_client.errors import VoltcamError

CAMERA, CLIENTS = "camera", "clients"


def make_keys(folder: Path, clients: list[str]) -> list[Path]:
    """Make the camera's pair where there is none, and a folder for each new client; returns those folders.

    The folders of clients are to be moved to their machines. Raises VoltcamError.
    """
    known = folder / CLIENTS
    try:
        known.mkdir(parents=True, exist_ok=True, mode=0o700)
        if not (folder / f"{CAMERA}.key_secret").exists():
            zmq.auth.create_certificates(folder, CAMERA)
            (folder / f"{CAMERA}.key_secret").chmod(0o600)
        return [_client(folder, known, name) for name in clients]
    except OSError as error:
        raise VoltcamError(f"{folder}: {error.strerror}: give a folder you may write to") from error


def _client(folder: Path, known: Path, name: str) -> Path:
    own = folder / f"for-{name}"
    if not name.isidentifier() or name == CAMERA:
        raise VoltcamError(f"{name!r} is no name for a client: give letters, digits and _")
    if own.exists() or (known / f"{name}.key").exists():
        raise VoltcamError(f"{name} has keys already: remove {known / name}.key to shut it out")
    own.mkdir(mode=0o700)
    public, secret = zmq.auth.create_certificates(own, name)
    Path(secret).chmod(0o600)
    shutil.move(public, known / f"{name}.key")
    shutil.copy(folder / f"{CAMERA}.key", own)
    return own


def pair(secret: Path) -> tuple[bytes, bytes]:
    """(public, secret) of a file. Raises VoltcamError."""
    try:
        public, private = zmq.auth.load_certificate(secret)
    except (OSError, ValueError) as error:
        raise VoltcamError(f"{secret}: no pair of keys: make them with `voltcam keys`") from error
    if private is None:
        raise VoltcamError(f"{secret} has no secret key: make keys with `voltcam keys`")
    return public, private


def use_keys(socket: zmq.SyncSocket, folder: Path) -> None:
    """Let a subscriber's socket use the keys of its folder. Raises VoltcamError."""
    secrets = sorted(folder.glob("*.key_secret"))
    if len(secrets) != 1 or not (folder / f"{CAMERA}.key").exists():
        raise VoltcamError(f"{folder} is no client's folder of keys: `voltcam keys` makes them, as for-NAME")
    socket.curve_publickey, socket.curve_secretkey = pair(secrets[0])
    socket.curve_serverkey = zmq.auth.load_certificate(folder / f"{CAMERA}.key")[0]
