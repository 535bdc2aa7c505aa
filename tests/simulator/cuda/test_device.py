"""What needs the device's own compiler, or shows that there is no device: in processes of their own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

COMPILES = Path(__file__).with_name("compiles.py")


def run(*command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *command], env={**os.environ, **environment}, capture_output=True, text=True,
        timeout=500, check=False,
    )  # fmt: skip


def test_without_a_device_one_line_says_what_to_do() -> None:
    code = "from voltcam_simulator import Simulator; Simulator(2, 2, device='cuda')"
    done = run("-c", code, NUMBA_ENABLE_CUDASIM="0", CUDA_VISIBLE_DEVICES="-1")
    last = done.stderr.strip().splitlines()[-1]
    assert "NoDeviceError: device cuda" in last
    assert "voltcam[cuda]" in last


def test_numba_does_not_warn_of_a_small_launch() -> None:
    """It does where a launch has fewer than 128 blocks: of a small sensor, of few events."""
    code = """if True:
        import warnings
        from numba import cuda
        from voltcam_simulator.cuda import arrays

        class Launched:  # as the kernel of a device, but for the run
            def __getitem__(self, shape):
                blocks.append(shape[0])
                cuda.jit(lambda: None)[shape]
                return lambda: None

        warnings.simplefilter("error")
        blocks = []
        for threads in (1, 128 * 128, 128 * 128 + 1, 1_000_000):
            arrays.launch(Launched(), threads)
        print(*blocks)
    """
    done = run("-c", code, NUMBA_ENABLE_CUDASIM="0")
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.split() == ["128", "128", "129", "7813"]


def test_all_kernels_compile_for_a_device() -> None:
    """For compute capability 9.0, by NVIDIA's own compiler, which needs no GPU: without fused products, and
    without memory but a thread's own."""
    done = run(str(COMPILES), NUMBA_ENABLE_CUDASIM="0")
    if done.returncode == 77:
        pytest.skip("NVVM or NVRTC is not installed: pip install 'numba-cuda[cu13]'")
    assert done.returncode == 0, done.stderr[-2000:]
    assert {line.split()[0] for line in done.stdout.splitlines()} == {
        "settle", "start", "step_all", "step_late", "_take", "_unpack",
    }  # fmt: skip
