"""docs/how-to/add-a-transport.md, followed to the letter on a copy of the repository."""

import shlex
import subprocess
from pathlib import Path

from .follow import follow

END_S = 30


def test_the_page_adds_a_transport(tmp_path: Path) -> None:
    page = follow("how-to/add-a-transport.md", tmp_path)
    schema, own_test, serve, receive = page.commands
    assert " passed" in page.run(schema)
    assert "1 passed" in page.run(own_test)
    aside = ["--http", "127.0.0.1:0", "--zmq", "tcp://127.0.0.1:0"]
    daemon = subprocess.Popen(
        [*shlex.split(serve), *aside], cwd=tmp_path, env=page.environment, stdout=subprocess.DEVNULL
    )
    try:
        lines = page.run(receive).splitlines()
    finally:
        daemon.terminate()
        daemon.wait(END_S)
    assert len(lines) == 100
    assert sum(int(line.split()[1]) for line in lines) > 0
