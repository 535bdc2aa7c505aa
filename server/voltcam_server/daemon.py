"""The daemon put together: emulator, transports and web server, from the settings to the last packet."""

import contextlib
import logging
import os
import socket
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import uvicorn
from fastapi import FastAPI

from voltcam_video import Clock

from .access import SourceRules, Tokens
from .access.connections import SOCKET_MESSAGE_BYTES, BoundedProtocol
from .access.reach import check_reach, host_of
from .announce import announced
from .api import Access, create_app
from .cameras import Cameras
from .listening import address_of, listen
from .plan import plans_of
from .problems import UsageError, where
from .recorder import RecordingPlan
from .reload import Reload
from .running_camera import RunningCamera, Surroundings
from .service import tell_systemd
from .settings import Settings
from .signals import ended_by_signal, reloaded_by_signal
from .status import Status
from .status_log import StatusLog

NOT_OURS = ("graceful shutdown", "Invalid HTTP request", "Unsupported upgrade request")
GRACE_S = 1  # for HTTP requests under way when the daemon ends


class _Server(uvicorn.Server):
    """uvicorn, which otherwise takes the signals and raises them again at its end."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def serve(
    settings: Settings,
    record: str | None,
    on_ready: Callable[[str, dict[str, dict[str, str]]], None],
    reread: Callable[[], Settings],
) -> None:
    """Run until SIGINT or SIGTERM. `on_ready` gets the page's address, and the addresses of each camera's
    transports, by their names.

    reread: the settings as they are then, for SIGHUP and REST. Raises UsageError for settings that cannot
    be, a port in use, a source that cannot be opened; RecordingError and FormatError for a recording that
    cannot be made.
    """
    plans = plans_of(settings)
    if record and len(plans) > 1:
        raise UsageError("--record is for one camera: begin the recordings of several over REST")
    access = _access(settings)
    cameras = Cameras()
    with contextlib.ExitStack() as stack:
        stack.callback(lambda: _leave(cameras))
        listener = stack.enter_context(listen(settings.http, "--http"))
        page = _url(listener, access.secure)
        around = Surroundings(
            page=page,
            keys=settings.access.curve_keys,
            clock=Clock(),
            on_status=_watcher(settings, cameras),
            on_failure=lambda: setattr(server, "should_exit", True),
        )
        reload = Reload(cameras, around, settings, lambda: _checked(reread()))
        app = create_app(cameras, access, reload)
        server = _web_server(app, settings)
        stack.enter_context(ended_by_signal(lambda: _end(server)))
        stack.enter_context(reloaded_by_signal(reload))
        stack.callback(cameras.stop)
        for plan in plans:
            cameras.replace([*cameras, RunningCamera.of(plan, around)])
        cameras.start()
        if record:
            cameras.get().emulator.recordings.begin(
                RecordingPlan(Path(record), least_free_bytes=settings.least_free_bytes)
            )
        if settings.announce:
            endpoints = {camera.name: camera.zmq for camera in cameras}
            stack.enter_context(announced(listener, access.secure, endpoints))
        on_ready(page, {camera.name: camera.addresses for camera in cameras})
        tell_systemd("READY=1")
        server.run(sockets=[listener])
        if cameras.failure is not None:
            raise UsageError(f"the daemon failed: {where(cameras.failure)}: please report it")


def _access(settings: Settings) -> Access:
    tokens = Tokens.load(settings.access.tokens_file)
    check_reach(settings, tokens)
    return Access(
        SourceRules(settings.access),
        tokens,
        settings.recordings,
        settings.least_free_bytes,
        [*settings.access.hosts, host_of(settings.http)],
        secure=settings.access.tls_certificate is not None,
    )


def _checked(settings: Settings) -> Settings:
    """As at the start: not open to anyone. Raises UsageError."""
    check_reach(settings, Tokens.load(settings.access.tokens_file))
    return settings


def _leave(cameras: Cameras) -> None:
    """Do not wait for what cannot be ended: an interval that takes seconds, a disk that does not answer."""
    if cameras.busy:
        logging.getLogger(__name__).warning(
            "ended in the middle of work that takes long; recordings can be read"
        )
        sys.stdout.flush()
        os._exit(0)


def _watcher(settings: Settings, cameras: Cameras) -> Callable[[str, Status], None]:
    """Log what changes, and let systemd's watchdog know that events are made, or that nobody sends frames."""
    logs: dict[str, StatusLog] = {}

    def watch(camera: str, status: Status) -> None:
        if camera not in logs:
            logs[camera] = StatusLog(settings.log, camera if settings.cameras else "")
        logs[camera].look(status)
        state, reason = cameras.state
        if state != "stalled":
            tell_systemd(f"WATCHDOG=1\nSTATUS={state} {reason}")

    return watch


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


def _url(listener: socket.socket, secure: bool) -> str:
    return f"{'https' if secure else 'http'}://{address_of(listener)}/"
