"""A camera over HTTP that stalls or dies, and comes back."""

import contextlib
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import cv2
import numpy as np
from numpy.typing import NDArray


class MjpegServer:
    """An HTTP camera, 50 frames per second until `stalled` is set; another may come back on its port.

    image: (height, width) grey levels of frame i.
    """

    def __init__(self, image: Callable[[int], NDArray[np.uint8]], port: int = 0) -> None:
        self.stalled = threading.Event()
        self.dead, self._image = threading.Event(), image
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
        i = 0
        while not self.dead.wait(0.02):
            if self.stalled.is_set():
                continue
            jpeg = cv2.imencode(".jpg", self._image(i))[1].tobytes()
            head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
            write(head.encode() + jpeg + b"\r\n")
            i += 1

    def die(self) -> None:
        """Closes all connections and the port."""
        self.dead.set()
        self._http.shutdown()
        self._thread.join()
        self._http.server_close()
