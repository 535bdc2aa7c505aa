"""Debian's kernel with its modules, unpacked into a folder: nothing is installed."""

import platform
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

PROGRAMS = {"qemu-system-x86_64": "qemu-system-x86", "busybox": "busybox-static", "v4l2-ctl": "v4l-utils"}
"""What must be here, and the package of Debian that has it."""
LIMIT_S = 120


class MissingError(Exception):
    """Something that this test needs cannot be had here."""


@dataclass(frozen=True)
class Kernel:
    """root: the folder it was unpacked into. version: as `uname -r` says it."""

    root: Path
    version: str

    @property
    def image(self) -> Path:
        return self.root / "boot" / f"vmlinuz-{self.version}"

    @property
    def modules(self) -> Path:
        return self.root / "lib" / "modules" / self.version


def check_programs() -> None:
    """Raises MissingError, with the remedy."""
    if platform.machine() != "x86_64":
        raise MissingError(
            f"the guest runs this machine's programs on x86-64, and this is {platform.machine()}"
        )
    missing = [package for program, package in PROGRAMS.items() if shutil.which(program) is None]
    if missing:
        raise MissingError(f"apt-get install --no-install-recommends {' '.join(missing)}")


def fetch(folder: Path) -> Kernel:
    """The newest kernel of this Debian, from `folder` where it is there already. Raises MissingError."""
    package = _package()
    version = package.removeprefix("linux-image-")
    kernel = Kernel(folder / package, version)
    if not (kernel.modules / "modules.dep").exists():
        shutil.rmtree(kernel.root, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
        for part in folder.glob("*.deb"):  # of a download that was cut
            part.unlink()
        _run("apt-get", "download", "-qq", package, cwd=folder)
        (deb,) = folder.glob(f"{package}_*.deb")
        _run("dpkg-deb", "-x", str(deb), str(kernel.root))
        deb.unlink()
        _run("busybox", "depmod", "-b", str(kernel.root), version)
    return kernel


def _package() -> str:
    """What the meta package stands for: the kernel for real machines, as that for clouds has no vivid."""
    depends = _run("apt-cache", "depends", "--important", "linux-image-amd64")
    for line in depends.splitlines():
        if line.strip().startswith("Depends: linux-image-"):
            return line.split()[-1]
    raise MissingError("apt-get update: there is no linux-image-amd64 in the lists")


def _run(*command: str, cwd: Path | None = None) -> str:
    try:
        done = subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True, timeout=LIMIT_S)
    except (OSError, subprocess.SubprocessError) as error:
        said = getattr(error, "stderr", "") or error
        raise MissingError(f"{command[0]}: {str(said).strip().splitlines()[-1]}") from None
    return done.stdout
