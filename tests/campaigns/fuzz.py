"""`make fuzz SECONDS=n`: small recordings of every format, damaged at random, through all readers.

Each damaged file is read in a process that may take MEMORY_BYTES and PATIENCE_S, many files to a process. A
reader must give a recording, or one line; a process that dies, hangs or shows anything else is a finding.
"""

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np
from tqdm import tqdm

from voltcam_client.errors import VoltcamError
from voltcam_client.formats import read

from .small_recordings import small_recordings

MEMORY_BYTES = 4_000_000_000  # of address space
PATIENCE_S = 20.0  # for a file
BATCH = 60


def main() -> int:
    """Fuzz for so long; returns 1 where there is a finding."""
    parser = argparse.ArgumentParser(prog="make fuzz", description=__doc__)
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--read", type=Path, help=argparse.SUPPRESS)  # what the processes do
    arguments = parser.parse_args()
    if arguments.read:
        return _read_all(arguments.read)
    rng, found, outcomes = np.random.default_rng(arguments.seed), [], Counter[str]()
    began_s = time.monotonic()
    with tempfile.TemporaryDirectory() as name, tqdm(unit="file", mininterval=5) as bar:
        seeds = small_recordings(Path(name))
        while time.monotonic() - began_s < arguments.seconds:
            folder = Path(name) / "batch"
            folder.mkdir()
            for number in range(BATCH):
                seed = seeds[rng.integers(len(seeds))]
                (folder / f"{number}{seed.suffix}").write_bytes(_damaged(seed.read_bytes(), rng))
            found += _read_in_a_process(folder, outcomes)
            shutil.rmtree(folder)
            bar.update(BATCH)
    sys.stdout.write("".join(f"{kind}: {count}\n" for kind, count in sorted(outcomes.items())))
    sys.stdout.write("".join(f"FOUND: {each}\n" for each in found) or "nothing was found\n")
    return 1 if found else 0


def _read_in_a_process(folder: Path, outcomes: "Counter[str]") -> list[str]:
    """What went wrong; where a process dies, the file it was at is left out, and another goes on."""
    found = []
    while True:
        command = [sys.executable, "-m", "tests.campaigns.fuzz", "--read", str(folder)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=PATIENCE_S * BATCH / 4, check=False
            )
            code, said = done.returncode, done.stderr
        except subprocess.TimeoutExpired:
            code, said = -1, "it hangs"
        outcomes.update(json.loads(line)["outcome"] for line in _lines(folder / "outcomes"))
        (folder / "outcomes").unlink(missing_ok=True)
        at = (folder / "at").read_text()
        if code == 0:
            return found
        kept = Path(tempfile.gettempdir()) / f"voltcam-fuzz-{time.time_ns()}{Path(at).suffix}"
        shutil.copy(at, kept)
        Path(at).unlink()
        found.append(f"{kept}: status {code}: {said[-300:]}")


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def _read_all(folder: Path) -> int:
    """In the process: read each file of the folder, and take it away."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    for path in sorted(folder.iterdir()):
        if path.stem in ("at", "outcomes"):
            continue
        (folder / "at").write_text(str(path))
        began_s = time.monotonic()
        try:
            recording = read(path)
            outcome = f"{path.suffix} read, {'some' if recording.events.size else 'no'} events"
        except (VoltcamError, OSError) as error:
            if "\n" in str(error):
                raise
            outcome = f"{path.suffix} refused"
        if time.monotonic() - began_s > PATIENCE_S:
            raise TimeoutError(f"{path} took {time.monotonic() - began_s:.0f} s")
        with (folder / "outcomes").open("a") as file:
            file.write(json.dumps({"outcome": outcome}) + "\n")
        path.unlink()
    return 0


def _damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Some bytes changed, numbers set to the largest, pieces taken out, doubled, or cut off."""
    content = bytearray(data)
    for _ in range(rng.integers(1, 9)):
        at = int(rng.integers(max(1, len(content))))
        if rng.random() < 0.5:
            at = min(at, int(rng.integers(300)))  # heads matter more
        match rng.integers(5):
            case 0:
                content[at : at + 1] = rng.bytes(1)
            case 1:
                width = int(rng.choice([1, 2, 4, 8]))
                content[at : at + width] = rng.choice([b"\xff", b"\x7f", b"\0", b"\x80"]) * width
            case 2:
                del content[at : at + int(rng.integers(1, 200))]
            case 3:
                content[at:at] = content[at : at + int(rng.integers(1, 200))] * int(rng.integers(1, 4))
            case _:
                del content[at : len(content) if rng.random() < 0.3 else at + 1]
    return bytes(content)


if __name__ == "__main__":
    sys.exit(main())
