"""docs/how-to/udp.md: its receivers receive what a daemon sends them."""

import importlib.util
import socket
import subprocess
import sys

import pytest
from tests.docs.blocks import DOCS, blocks
from tests.server.process import Daemon
from tests.server.rig import PATIENCE_S


@pytest.mark.parametrize(("library", "form"), [("faery", "t32_x16_y15_on1"), ("aestream", "spif")])
def test_a_receiver_of_the_page_receives(library: str, form: str) -> None:
    if importlib.util.find_spec(library) is None:
        pytest.skip(f"{library} is not installed")
    texts = [block.text for block in blocks(DOCS / "how-to" / "udp.md") if block.language == "python"]
    (program,) = [text for text in texts if library in text]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        port = str(one.getsockname()[1])
    receiver = subprocess.Popen(
        [sys.executable, "-c", program.replace("3333", port)], stdout=subprocess.PIPE, text=True
    )
    try:
        with Daemon("--dv", "off", "--udp", f"{form}://127.0.0.1:{port}"):
            printed, _ = receiver.communicate(timeout=2 * PATIENCE_S)
    finally:
        receiver.kill()
    assert float(printed.split()[0]) >= 1000
