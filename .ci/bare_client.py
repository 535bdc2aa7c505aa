"""The bare install must give a robot the client and nothing heavy, and say what the rest needs."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import voltcam_client

assert voltcam_client.EventCamera
for heavy in ("numba", "cv2", "fastapi", "pydantic"):
    assert importlib.util.find_spec(heavy) is None, f"{heavy} came with the bare install"
command = Path(sys.executable).with_name("voltcam")
answer = subprocess.run([command, "serve"], capture_output=True, text=True, check=False)
assert answer.returncode != 0, answer
assert "voltcam[server]" in answer.stderr, answer.stderr
assert "Traceback" not in answer.stderr, answer.stderr
