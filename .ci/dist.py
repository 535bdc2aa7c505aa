"""Build wheel and sdist, check them, install each with each extra into an empty environment and use it there.

python .ci/dist.py                                            all: `make dist`
python .ci/dist.py --artefacts wheel --extras bare server     what `.ci/run` does
"""

import argparse
import os
import subprocess
import sys
import tarfile
import tempfile
import time
import tomllib
import venv
import zipfile
from email import message_from_string
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
FIRST_USE = Path(__file__).with_name("first_use.py")
EXTRAS = {
    "bare": "",
    "simulator": "[simulator]",
    "lab": "[lab]",
    "server": "[server]",
    "announce": "[server,announce]",
}
DATA = (".css", ".html", ".js", ".svg", ".typed", ".yaml")
LIMIT_S = 1200  # for one command


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--artefacts", nargs="+", choices=["wheel", "sdist"], default=["wheel", "sdist"])
    parser.add_argument("--extras", nargs="+", choices=list(EXTRAS), default=list(EXTRAS))
    parser.add_argument(
        "--out", type=Path, default=ROOT / "dist", help="folder of wheel and sdist (default: dist)"
    )
    arguments = parser.parse_args()
    files = build(arguments.out)
    check_sdist(files["sdist"])
    run(sys.executable, "-m", "twine", "check", "--strict", *files.values())
    say("metadata: twine finds nothing wrong")
    wanted = [(artefact, extra) for artefact in arguments.artefacts for extra in arguments.extras]
    for number, (artefact, extra) in enumerate(wanted, start=1):
        say(f"[{number}/{len(wanted)}] {files[artefact].name} {EXTRAS[extra] or 'without extras'}")
        try_out(files[artefact], extra)
    say(f"all is well: {' '.join(str(file) for file in files.values())}")


def build(out: Path) -> dict[str, Path]:
    """The wheel, of the sdist and with kernels compiled ahead, and the sdist: all that is in `out` then."""
    out.mkdir(exist_ok=True)
    for former in [*out.glob("voltcam-*.whl"), *out.glob("voltcam-*.tar.gz")]:
        former.unlink()
    run(sys.executable, "-m", "build", "--sdist", "--outdir", out, ROOT)
    (sdist,) = out.glob("voltcam-*.tar.gz")
    with tempfile.TemporaryDirectory(prefix="voltcam-wheel-") as folder, tarfile.open(sdist) as opened:
        opened.extractall(folder, filter="data")
        (source,) = Path(folder).iterdir()
        run(sys.executable, "-m", "voltcam_simulator.ahead", cwd=source / "simulator")
        run(sys.executable, "-m", "build", "--wheel", "--outdir", out, source)
        (wheel,) = out.glob("voltcam-*.whl")
        say(f"built: {wheel.name} ({kilobytes(wheel)}), {sdist.name} ({kilobytes(sdist)})")
        check_wheel(wheel, source)
    return {"wheel": wheel, "sdist": sdist}


def check_wheel(wheel: Path, source: Path) -> None:
    """It has the files of the five packages, its metadata, and nothing else."""
    packages = [
        source / package for package in PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    ]
    wanted = {
        file.relative_to(package.parent).as_posix()
        for package in packages
        for file in package.rglob("*")
        if file.is_file() and "__pycache__" not in file.parts
    }
    with zipfile.ZipFile(wheel) as opened:
        names = set(opened.namelist())
        info = next(name for name in names if name.endswith(".dist-info/METADATA"))
        metadata = message_from_string(opened.read(info).decode())
    own = {name for name in names if not name.startswith(info.split("/")[0])}
    if own != wanted:
        sys.exit(f"{wheel.name}: too much {sorted(own - wanted)}, missing {sorted(wanted - own)}")
    for package in packages:
        if f"{package.name}/py.typed" not in own:
            sys.exit(f"{wheel.name}: {package.name} has no py.typed")
    if not any(name.endswith("/licenses/LICENSE") for name in names):
        sys.exit(f"{wheel.name}: no licence")
    if metadata["Version"] != PROJECT["project"]["version"]:
        sys.exit(
            f"{wheel.name}: version {metadata['Version']}, pyproject.toml has {PROJECT['project']['version']}"
        )
    data = sum(name.endswith(DATA) for name in own)
    say(f"wheel: {len(own)} files, {data} of them data; no more and no less than the packages have")


def check_sdist(sdist: Path) -> None:
    """It has what the wheel is built from, and the tests."""
    with tarfile.open(sdist) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    wanted = {
        "pyproject.toml",
        "README.md",
        "LICENSE",
        "CHANGELOG.md",
        "Makefile",
        "tests/docker/test_image.py",
    }
    if missing := wanted - names:
        sys.exit(f"{sdist.name}: missing {sorted(missing)}")
    if surplus := [name for name in names if name.startswith((".venv", "dist/", ".git/"))]:
        sys.exit(f"{sdist.name}: too much {sorted(surplus)[:5]}")
    say(f"sdist: {len(names)} files")


def try_out(file: Path, extra: str) -> None:
    """Install into an environment that has nothing, and run first_use.py there, outside of the repository."""
    with tempfile.TemporaryDirectory(prefix="voltcam-dist-") as folder:
        began_s = time.monotonic()
        venv.create(Path(folder, "venv"), with_pip=True)
        python = Path(folder, "venv", "bin", "python")
        run(python, "-m", "pip", "install", "--quiet", "--no-compile", f"{file.resolve()}{EXTRAS[extra]}")
        run(python, "-m", "pip", "check")
        installed_s = time.monotonic()
        run(python, "-I", FIRST_USE, extra, cwd=folder, XDG_CACHE_HOME=str(Path(folder, "cache")))
        used_s = time.monotonic()
        compiled = len([*Path(folder, "cache").rglob("*.nbc")])
        say(
            f"        installed in {installed_s - began_s:.0f} s, used in {used_s - installed_s:.0f} s, "
            f"{compiled} kernels compiled"
        )
        if file.suffix == ".whl" and compiled and numba_of(python) == numba_of(sys.executable):
            sys.exit(
                f"{file.name}: its kernels were not used, though Python and Numba are those it was built with"
            )


def numba_of(python: object) -> str:
    """The version of Numba that an interpreter has."""
    program = "from importlib.metadata import version; print(version('numba'))"
    return subprocess.check_output([str(python), "-I", "-c", program], text=True)


def run(*command: object, cwd: str | Path = ROOT, **environment: str) -> None:
    """Run a command; where it fails, show what it said and end."""
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    if done.returncode != 0:
        sys.exit(f"{done.stdout}\nfailed with {done.returncode}: {' '.join(map(str, command))}")


def kilobytes(file: Path) -> str:
    return f"{file.stat().st_size / 1000:.0f} kB"


def say(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    main()
