"""ZeroMQ: XPUB, multipart [topic, header, buffer] (status: [topic, header]).

Only what someone subscribes to is encoded. A subscriber that does not keep up loses packets, which it sees
in `seq`: libzmq drops them in that subscriber's queue, and does not tell us.
"""

import logging
import time
from pathlib import Path
from typing import ClassVar

import zmq
from zmq.auth.thread import ThreadAuthenticator

from voltcam_client.errors import VoltcamError
from voltcam_client.keys import CAMERA, CLIENTS, pair
from voltcam_client.packet import TOPIC_EVENTS

from ..messages import Message
from ..problems import UsageError
from .transport import Transport, TransportStatus

SEND_QUEUE_MESSAGES = 1000  # of each subscriber
# What subscribers may say: libzmq keeps all topics of all of them, and is busy with each when one leaves.
SUBSCRIPTION_BYTES, KEYED_BYTES = 64, 512  # longest message; a handshake with keys needs 300
SAID_AT_ONCE = 16  # messages of a subscriber that are taken before we look
MOST_TOPICS = 500  # of all subscribers; there are three to subscribe to
BIND_AGAIN_S, BIND_PERIOD_S = 2.0, 0.02
TOLD_S = 10.0
# A subscriber that vanished gives its queue back after 15 s. By TCP and not by ZMTP's heartbeats, with which
# libzmq (4.3.5) aborts the process when a connection ends whose queue is full (libzmq issues 4364, 4767).
KEEPALIVE_IDLE_S, KEEPALIVE_PERIOD_S, KEEPALIVE_PROBES = 5, 5, 2


class ZeroMQTransport(Transport):
    """Publishes on `endpoint`; binds at once. Raises UsageError when that is not possible.

    keys: the folder of the camera's keys, where only who has one of `clients` in it may listen.
    """

    name: ClassVar[str] = "zeromq"

    def __init__(self, endpoint: str, encoding: str, keys: Path | None = None) -> None:
        super().__init__()
        self._encoding, self._keys = encoding, keys
        self._sent = self._lost = 0
        self._told_s = -TOLD_S
        self._authenticator: ThreadAuthenticator | None = None
        self._topics: set[bytes] = set()
        self._context = zmq.Context()
        self._socket = self._unbound(endpoint)
        if keys is not None:
            self._authenticate(keys)
            self._use_keys(keys)
        try:
            self._socket.bind(endpoint)
        except zmq.ZMQError as error:
            self._close()
            raise UsageError(
                f"{endpoint}: {error.strerror}: end the program that has it, or choose another with --zmq"
            ) from None
        self.endpoint = self._socket.getsockopt_string(zmq.LAST_ENDPOINT)

    def _unbound(self, endpoint: str) -> zmq.SyncSocket:
        publisher: zmq.SyncSocket = self._context.socket(zmq.XPUB)
        publisher.linger = 0
        publisher.sndhwm = SEND_QUEUE_MESSAGES
        publisher.rcvhwm = SAID_AT_ONCE
        publisher.maxmsgsize = SUBSCRIPTION_BYTES if self._keys is None else KEYED_BYTES
        publisher.tcp_keepalive = 1
        publisher.tcp_keepalive_idle = KEEPALIVE_IDLE_S
        publisher.tcp_keepalive_intvl = KEEPALIVE_PERIOD_S
        publisher.tcp_keepalive_cnt = KEEPALIVE_PROBES
        publisher.ipv6 = "[" in endpoint
        return publisher

    def _authenticate(self, folder: Path) -> None:
        """Let in the keys of the folder only."""
        self._authenticator = ThreadAuthenticator(self._context)
        self._authenticator.start()
        self._authenticator.configure_curve(domain="*", location=folder / CLIENTS)

    def _use_keys(self, folder: Path) -> None:
        """Encrypt. Raises UsageError."""
        try:
            public, secret = pair(folder / f"{CAMERA}.key_secret")
        except VoltcamError as error:
            self._close()
            raise UsageError(f"access.curve_keys: {error}") from None
        self._socket.curve_publickey, self._socket.curve_secretkey = public, secret
        self._socket.curve_server = True

    @property
    def status(self) -> TransportStatus:
        return TransportStatus(address=self.endpoint, packets_sent=self._sent, packets_dropped=self._lost)

    def _send(self, message: Message) -> None:
        self._take_subscriptions()
        if not any(message.topic.startswith(topic) for topic in self._topics):
            return
        self._socket.send_multipart([message.topic, *message.parts(self._encoding)], copy=False)
        self._sent += message.topic == TOPIC_EVENTS

    def _take_subscriptions(self) -> None:
        """XPUB tells a topic's first subscriber and the loss of its last: byte 1 or 0, then the topic."""
        while self._socket.poll(0):
            if len(self._topics) > MOST_TOPICS:
                self._begin_again()
                return
            news = self._socket.recv()
            if news[:1] == b"\1":
                self._topics.add(news[1:])
            elif news[:1] == b"\0":
                self._topics.discard(news[1:])

    def _begin_again(self) -> None:
        """Let all subscribers go, with all that they have said; who wants to come again does so at once."""
        if time.monotonic() - self._told_s > TOLD_S:
            self._told_s = time.monotonic()
            words = "more than %d topics are subscribed to: all subscribers are let go"
            logging.getLogger(__name__).warning("%s: " + words, self.endpoint, MOST_TOPICS)
        self._topics.clear()
        self._socket.unbind(self.endpoint)
        self._socket.close()
        self._socket = self._unbound(self.endpoint)
        if self._keys is not None:
            self._use_keys(self._keys)
        deadline_s = time.monotonic() + BIND_AGAIN_S
        while True:
            try:
                self._socket.bind(self.endpoint)
            except zmq.ZMQError:  # libzmq is not done with the former socket
                if time.monotonic() > deadline_s:
                    raise
                time.sleep(BIND_PERIOD_S)
            else:
                return

    def _dropped(self, message: Message) -> None:
        self._lost += message.topic == TOPIC_EVENTS

    def _close(self) -> None:
        self._socket.close()
        if self._authenticator is not None:
            self._authenticator.stop()
        self._context.term()
