"""A camera over HTTP that dies, and comes back."""

import contextlib
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import cv2
import numpy as np


class MjpegServer:
    """An HTTP camera, 50 frames per second of moving bars; it dies, and another comes back on its port."""

    def __init__(self, port: int = 0) -> None:
        self._dead = threading.Event()
        camera = self

        class Handler(BaseHTTPRequestHandler):
            def log_message(self, format: str, *args: object) -> None:
                pass

            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
                self.end_headers()
                with contextlib.suppress(OSError):  # the client left
                    camera._send(self.wfile.write)

        self._http = ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self._http.daemon_threads = True
        self.port = self._http.server_address[1]
        self.url = f"http://127.0.0.1:{self.port}/"
        self._thread = threading.Thread(target=self._http.serve_forever, args=(0.02,))
        self._thread.start()

    def _send(self, write: Callable[[bytes], object]) -> None:
        image, i = np.tile(np.repeat(np.array([40, 200], np.uint8), 8), (48, 4)), 0
        while not self._dead.wait(0.02):
            jpeg = cv2.imencode(".jpg", np.roll(image, i, axis=1))[1].tobytes()
            head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
            write(head.encode() + jpeg + b"\r\n")
            i += 1

    def die(self) -> None:
        """Closes all connections and the port."""
        self._dead.set()
        self._http.shutdown()
        self._thread.join()
        self._http.server_close()
