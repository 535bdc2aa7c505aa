"""A machine that QEMU emulates, with a limit on its time and memory; nothing of it is left behind."""

import resource
import subprocess
import time
from pathlib import Path

from .kernel import Kernel

GUEST_MB, MEMORY_BYTES = 2048, 6_000_000_000
END_S = 10
TIMED_OUT = 124  # what `timeout` returns then


def boot(kernel: Kernel, initramfs: Path, folder: Path, limit_s: float) -> tuple[list[str], float]:
    """Run it until it switches itself off, or for `limit_s`: what it said on its second line, and seconds.

    `folder` keeps both lines: console, of the kernel and of all programs, and said, of the test.
    """
    console, said = folder / "console", folder / "said"
    command = [
        *("timeout", "--kill-after=5", str(limit_s)),  # also where this process ends before
        *("nice", "-n", "10", "qemu-system-x86_64"),
        *("-accel", "tcg,thread=multi,tb-size=256", "-cpu", "max", "-smp", "2", "-m", str(GUEST_MB)),
        *("-nodefaults", "-no-user-config", "-display", "none", "-no-reboot"),
        *("-kernel", str(kernel.image), "-initrd", str(initramfs)),
        *("-append", "console=ttyS0 quiet panic=-1 mitigations=off"),
        *("-serial", f"file:{console}", "-serial", f"file:{said}"),
        *("-fsdev", "local,id=host,path=/,security_model=none,readonly=on,multidevs=remap"),
        *("-device", "virtio-9p-pci,fsdev=host,mount_tag=host"),
    ]
    began_s = time.monotonic()
    with (folder / "qemu").open("w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log, preexec_fn=_bound)
        try:
            if process.wait(limit_s + 2 * END_S) == TIMED_OUT:
                log.write(f"ended after {limit_s:.0f} s, unfinished\n")
        finally:
            process.terminate()  # which `timeout` hands on
            process.wait(END_S)
    took_s = time.monotonic() - began_s
    lines = said.read_text(errors="replace").splitlines() if said.exists() else []
    return lines, took_s


def _bound() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
