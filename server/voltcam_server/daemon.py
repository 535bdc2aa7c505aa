"""The daemon put together: emulator, transports and web server, from the settings to the last packet."""

import contextlib
import logging
import os
import socket
import sys
from collections.abc import Callable, Iterator

import uvicorn
from fastapi import FastAPI

from voltcam_simulator import Camera
from voltcam_video import SourceError

from .access import SourceRules, Tokens
from .access.connections import SOCKET_MESSAGE_BYTES, BoundedProtocol
from .access.reach import check_reach, host_of
from .api import Access, CameraAnswer, check_encoding, create_app
from .diagnosis import Diagnosis
from .emulator import Emulator
from .problems import UsageError, one_line, where
from .service import tell_systemd
from .settings import Settings
from .signals import ended_by_signal
from .status import Status
from .status_log import StatusLog
from .transports import WebSocketTransport, ZeroMQTransport

NOT_OURS = ("graceful shutdown", "Invalid HTTP request", "Unsupported upgrade request")
GRACE_S = 1  # for HTTP requests under way when the daemon ends


class _Server(uvicorn.Server):
    """uvicorn, which otherwise takes the signals and raises them again at its end."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def serve(settings: Settings, record: str | None, on_ready: Callable[[str, str], None]) -> None:
    """Run until SIGINT or SIGTERM. `on_ready` gets the page's address and the ZeroMQ endpoint.

    Raises UsageError for settings that cannot be, a port in use, a source that cannot be opened;
    RecordingError and FormatError for a recording that cannot be made.
    """
    camera = settings.load_camera()
    check_encoding(settings.encoding, camera.width, camera.height)
    tokens = Tokens.load(settings.access.tokens_file)
    check_reach(settings, tokens)
    access = Access(
        SourceRules(settings.access, settings.source.uri),
        tokens,
        settings.recordings,
        [*settings.access.hosts, host_of(settings.http)],
        secure=settings.access.tls_certificate is not None,
    )
    emulator: Emulator | None = None
    with contextlib.ExitStack() as stack:
        stack.callback(lambda: _leave(emulator))
        listener = stack.enter_context(_listen(settings.http))
        page = _url(listener, access.secure)
        zeromq = ZeroMQTransport(settings.zmq, settings.encoding, settings.access.curve_keys)
        stack.callback(zeromq.stop)
        websockets = WebSocketTransport(page)
        stack.callback(websockets.stop)
        emulator = Emulator(
            camera,
            settings.source,
            law=settings.law,
            seed=settings.seed,
            upsample=settings.upsample,
            packets=settings.packets,
            overload=settings.overload,
            transports=[zeromq, websockets],
            on_status=_watcher(settings),
            on_failure=lambda: setattr(server, "should_exit", True),
        )
        stack.callback(emulator.stop)
        diagnosis = Diagnosis(emulator, zeromq.endpoint)
        stack.callback(diagnosis.stop)
        app = create_app(emulator, websockets, _about(camera, settings, zeromq), diagnosis, access)
        server = _web_server(app, settings)
        stack.enter_context(ended_by_signal(lambda: _end(server)))
        try:
            emulator.start()
        except SourceError as error:
            raise UsageError(one_line(error)) from None
        zeromq.start()
        websockets.start()
        if record:
            emulator.record(record)
        on_ready(page, zeromq.endpoint)
        tell_systemd("READY=1")
        server.run(sockets=[listener])
        if emulator.failure is not None:
            raise UsageError(f"the daemon failed: {where(emulator.failure)}: please report it")


def _leave(emulator: Emulator | None) -> None:
    """Do not wait for what cannot be ended: an interval that takes seconds, a disk that does not answer."""
    if emulator is not None and emulator.busy:
        logging.getLogger(__name__).warning(
            "ended in the middle of work that takes long; recordings can be read"
        )
        sys.stdout.flush()
        os._exit(0)


def _watcher(settings: Settings) -> Callable[[Status], None]:
    """Log what changes, and let systemd's watchdog know that events are made, or that nobody sends frames."""
    log = StatusLog(settings.log)

    def watch(status: Status) -> None:
        log.look(status)
        if status.state != "stalled":
            tell_systemd(f"WATCHDOG=1\nSTATUS={status.state} {status.reason}")

    return watch


def _about(camera: Camera, settings: Settings, zeromq: ZeroMQTransport) -> CameraAnswer:
    return CameraAnswer(
        name=camera.name,
        width=camera.width,
        height=camera.height,
        law=settings.law,
        seed=settings.seed,
        encoding=settings.encoding,
        zmq=zeromq.endpoint,
        parameters=camera.parameters,
    )


def _web_server(app: FastAPI, settings: Settings) -> uvicorn.Server:
    config = uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=GRACE_S,
        lifespan="off",
        http=BoundedProtocol,
        ws_max_size=SOCKET_MESSAGE_BYTES,
        server_header=False,
        ssl_certfile=settings.access.tls_certificate,
        ssl_keyfile=settings.access.tls_key,
    )
    # A client that does not read cannot be told of the end, and what is no HTTP is answered with 400: neither
    # is an error of ours, and strangers must not fill the log.
    logging.getLogger("uvicorn.error").addFilter(
        lambda record: not any(words in record.getMessage() for words in NOT_OURS)
    )
    return _Server(config)


def _end(server: uvicorn.Server) -> None:
    tell_systemd("STOPPING=1")
    server.should_exit = True
    if not server.started:  # still waiting for the source
        raise KeyboardInterrupt


def _listen(address: str) -> socket.socket:
    """A listening socket. Raises UsageError."""
    host, _, port = address.rpartition(":")
    if int(port) > 65535:  # which getaddrinfo would take modulo 65536
        raise UsageError(f"{address}: no port is above 65535: give --http HOST:PORT")
    try:
        family, kind, proto, _, sockaddr = socket.getaddrinfo(
            host.strip("[]"), int(port), type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listener = socket.socket(family, kind, proto)
    except (OSError, OverflowError) as error:
        raise UsageError(f"{address}: {getattr(error, 'strerror', error)}: give --http HOST:PORT") from None
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(sockaddr)
        listener.listen(128)
    except (OSError, OverflowError) as error:
        listener.close()
        reason = getattr(error, "strerror", None) or error
        raise UsageError(
            f"{address}: {reason}: end the program that has the port, or choose another with --http"
        ) from None
    return listener


def _url(listener: socket.socket, secure: bool) -> str:
    host, port = listener.getsockname()[:2]
    scheme = "https" if secure else "http"
    return (
        f"{scheme}://[{host}]:{port}/" if listener.family == socket.AF_INET6 else f"{scheme}://{host}:{port}/"
    )
