"""`--device cuda`: in numba's simulator of a GPU, and without one."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from voltcam_client.formats import read

CAMERA = "name: tiny\nwidth: 6\nheight: 5\nphotoreceptor_bandwidth: {cutoff_hz: 300}\n"
RUN = "import sys; from voltcam_client.cli import main; sys.exit(main())"


def convert(output: Path, device: str, simulated: str) -> subprocess.CompletedProcess[str]:
    camera = output.with_name("tiny.yaml")
    camera.write_text(CAMERA)
    given = ["--camera", str(camera), "--seconds", "0.1", "--device", device]
    return subprocess.run(
        [sys.executable, "-c", RUN, "convert", "scene", str(output), *given],
        env=os.environ | {"NUMBA_ENABLE_CUDASIM": simulated, "CUDA_VISIBLE_DEVICES": "-1"},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip


def test_convert_gives_the_same_events_on_both(tmp_path: Path) -> None:
    cpu, cuda = tmp_path / "cpu.npz", tmp_path / "cuda.npz"
    for path, device in ((cpu, "cpu"), (cuda, "cuda")):
        done = convert(path, device, "1")
        assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(read(cuda).events, expected := read(cpu).events)
    assert len(expected) > 10


def test_without_a_gpu_one_line_says_what_to_do(tmp_path: Path) -> None:
    done = convert(tmp_path / "cuda.npz", "cuda", "0")
    assert done.returncode == 1
    (line,) = done.stderr.strip().splitlines()
    assert line.startswith("voltcam: device cuda")
    assert "voltcam[cuda]" in line
    assert not (tmp_path / "cuda.npz").exists()
