"""What the kernel starts with: busybox, the modules that reach this machine's files, and a script."""

import gzip
import shutil
import subprocess
from pathlib import Path

from .kernel import Kernel

BOOT_MODULES = ("virtio_pci", "9pnet_virtio", "9p", "overlay")
INIT = """#!/bin/busybox sh
busybox mkdir -p /proc /sys /host /own /guest
busybox mount -t proc proc /proc
busybox modprobe -a {modules}
busybox mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=1048576,cache=loose host /host
busybox mount -t tmpfs -o size=512m own /own
busybox mkdir /own/files /own/work
busybox mount -t overlay -o lowerdir=/host,upperdir=/own/files,workdir=/own/work guest /guest
busybox mount -t proc proc /guest/proc
busybox mount -t sysfs sys /guest/sys
busybox mount -t devtmpfs dev /guest/dev
busybox mkdir -p /guest/dev/shm /guest/lib/modules
busybox mount -t tmpfs shm /guest/dev/shm
busybox ln -s {kernel} /guest/lib/modules/{version}
busybox ifconfig lo 127.0.0.1 up
cd /
echo "guest: files are there after $(busybox cut -d ' ' -f 1 /proc/uptime) s"
busybox chroot /guest /bin/sh -c '{command}'
busybox poweroff -f
"""


def build(kernel: Kernel, command: str, folder: Path) -> Path:
    """The packed initramfs, in `folder`; it runs `command` on this machine's files, read only."""
    root = folder / "initramfs"
    shutil.rmtree(root, ignore_errors=True)
    (root / "bin").mkdir(parents=True)
    busybox = shutil.which("busybox")
    assert busybox is not None
    shutil.copy(busybox, root / "bin" / "busybox")
    (root / "bin" / "modprobe").symlink_to("busybox")
    for name in ("dev", "lib/modules"):
        (root / name).mkdir(parents=True)
    _copy_modules(kernel, root / "lib" / "modules" / kernel.version)
    script = INIT.format(
        modules=" ".join(BOOT_MODULES), kernel=kernel.modules, version=kernel.version, command=command
    )
    init = root / "init"
    init.write_text(script)
    init.chmod(0o755)
    return _pack(root, folder / "initramfs.gz")


def _copy_modules(kernel: Kernel, to: Path) -> None:
    """Those that are needed before the files are there, with what they need themselves."""
    listed = (kernel.modules / "modules.dep").read_text().splitlines()
    needs = dict(line.split(":", 1) for line in listed)
    for module, others in needs.items():
        if Path(module).stem in BOOT_MODULES:
            for each in (module, *others.split()):
                (to / each).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(kernel.modules / each, to / each)
    shutil.copy(kernel.modules / "modules.dep", to)


def _pack(root: Path, file: Path) -> Path:
    names = "\n".join(str(path.relative_to(root)) for path in sorted(root.rglob("*")))
    archive = subprocess.run(
        ["busybox", "cpio", "-o", "-H", "newc"],
        cwd=root,
        input=names.encode(),
        check=True,
        capture_output=True,
        timeout=60,
    ).stdout
    file.write_bytes(gzip.compress(archive, 1))
    return file
