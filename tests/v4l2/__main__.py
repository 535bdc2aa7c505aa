"""Boots the guest and judges what it said. Returns 1 where something did not hold.

Where QEMU or the kernel cannot be had, it says so and returns 0.
"""

import argparse
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import yaml

from voltcam_simulator import Camera

from .initramfs import build
from .kernel import MissingError, check_programs, fetch
from .machine import boot

REPOSITORY = Path(__file__).parents[2]
LIMIT_S = 420.0  # on a machine that does other things, too; alone it takes much less
KERNELS = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}
"""What QEMU can emulate: kernels are compiled for it here, where that takes seconds."""


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(prog="make v4l2", description=__doc__)
    parser.add_argument("--limit-s", type=float, default=LIMIT_S)
    arguments = parser.parse_args()
    folder = REPOSITORY / "build" / "v4l2"
    try:
        check_programs()
        kernel = fetch(folder)
    except MissingError as error:
        sys.stdout.write(f"V4L2 SKIPPED, it cannot be tried here: {error}\n")
        return 0
    camera = _camera(folder)
    _compile(camera, folder)
    initramfs = build(kernel, _command(camera, folder), folder)
    said, took_s = boot(kernel, initramfs, folder, arguments.limit_s)
    return _judge(said, took_s, folder)


def _camera(folder: Path) -> Path:
    """Small and without noise: where nothing moves there are no events."""
    file = folder / "small.yaml"
    size = {"name": "small", "width": 64, "height": 36}
    file.write_text(yaml.safe_dump(size | Camera.load("ideal").parameters.model_dump()))
    return file


def _environment(folder: Path) -> dict[str, str]:
    return KERNELS | {"XDG_CACHE_HOME": str(folder / "cache")}


def _compile(camera: Path, folder: Path) -> None:
    command = [sys.executable, "-m", "tests.v4l2.warm", str(camera)]
    subprocess.run(command, cwd=REPOSITORY, env=os.environ | _environment(folder), check=True, timeout=240)


def _command(camera: Path, folder: Path) -> str:
    inside = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "LANG": "C.UTF-8"}
    settings = " ".join(f"{name}={value}" for name, value in (inside | _environment(folder)).items())
    python, module = shlex.quote(sys.executable), "tests.v4l2.guest"
    return f"cd {REPOSITORY} && exec env -i {settings} {python} -m {module} {camera}"


def _judge(said: list[str], took_s: float, folder: Path) -> int:
    results = [json.loads(line) for line in said if line.startswith("{") and line.endswith("}")]
    tried = [result for result in results if "what" in result]
    lines = [f"{'held' if each['held'] else 'NOT HELD'}: {each['what']}: {each['saw']}" for each in tried]
    ended = {"end": True} in results
    if not ended:
        console = (folder / "console").read_text(errors="replace").splitlines()[-40:]
        lines += ["NOT HELD: the guest came to its end. The last of its console:", *console]
        lines += (folder / "qemu").read_text().splitlines()[-5:]
    lines.append(f"{len(tried)} tried, {took_s:.0f} s from the start of the machine to its end")
    sys.stdout.write("\n".join(lines) + "\n")
    return 0 if ended and tried and all(each["held"] for each in tried) else 1


if __name__ == "__main__":
    sys.exit(main())
