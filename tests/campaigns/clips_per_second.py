"""How many clips a second a core gives a training loop: simulated as they are asked for, or read from HDF5.

    python -m tests.campaigns.clips_per_second PHOTOGRAPHS

The same clips either way: 20 windows of 40 ms and 128 x 128 pixels, five slices of time. Files have raw
events, of which the loader makes grids, or grids. One process, one thread, by its processor time.
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import hdf5plugin
import numpy as np
import torch

from voltcam_lab.torch import EventClips, Photographs
from voltcam_simulator import EVENT

SIZE, WINDOWS, WINDOW_US = 128, 20, 40_000
Grids = Iterator[Any]


def clips_of(photographs: Path, count: int) -> EventClips:
    return EventClips(
        Photographs(photographs),
        "davis346",
        width=SIZE,
        height=SIZE,
        windows=WINDOWS,
        window_us=WINDOW_US,
        clips=count,
    )


def stored(clips: EventClips, count: int, folder: Path) -> None:
    """Both files, with the compression of DSEC's (Blosc, Zstandard)."""
    packed = hdf5plugin.Blosc(cname="zstd", clevel=5, shuffle=1)
    with h5py.File(folder / "events.h5", "w") as events, h5py.File(folder / "grids.h5", "w") as grids:
        for number in range(count):
            clip = clips.clip(0, number)
            for window, each in enumerate(clip.events):
                for name in "txyp":
                    kind = "u1" if name == "p" else "u4" if name == "t" else "u2"
                    events.create_dataset(f"{number}/{window}/{name}", data=each[name].astype(kind), **packed)
            made = np.stack([clips.shape.represented(each) for each in clip.events])
            grids.create_dataset(f"{number}/grids", data=made.astype(np.float16), **packed)
            for file in (events, grids):
                file.create_dataset(f"{number}/images", data=np.rint(clip.images).astype(np.uint8), **packed)


def from_events(clips: EventClips, count: int, folder: Path) -> Grids:
    with h5py.File(folder / "events.h5") as file:
        for number in range(count):
            made = []
            for window in range(WINDOWS):
                group = file[f"{number}/{window}"]
                columns = {name: group[name][:] for name in "txyp"}
                each = np.empty(len(columns["t"]), EVENT)
                for name, column in columns.items():
                    each[name] = column
                made.append(clips.shape.represented(each))
            yield torch.from_numpy(np.stack(made)), torch.from_numpy(file[f"{number}/images"][:]).float()


def from_grids(count: int, folder: Path) -> Grids:
    with h5py.File(folder / "grids.h5") as file:
        for number in range(count):
            yield (
                torch.from_numpy(file[f"{number}/grids"][:]).float(),
                torch.from_numpy(file[f"{number}/images"][:]).float(),
            )


def clips_per_cpu_second(run: Callable[[], Grids]) -> float:
    began_s, count = time.process_time(), 0
    for _ in run():
        count += 1
    return count / (time.process_time() - began_s)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("photographs", type=Path)
    parser.add_argument("--clips", type=int, default=30)
    args = parser.parse_args()
    torch.set_num_threads(1)
    clips = clips_of(args.photographs, args.clips)
    for _ in clips:  # compiles, and reads the photographs
        pass
    clips.set_epoch(0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        stored(clips, args.clips, folder)
        ways: dict[str, Callable[[], Grids]] = {
            "simulated": lambda: iter(clips),
            "events from HDF5": lambda: from_events(clips, args.clips, folder),
            "grids from HDF5": lambda: from_grids(args.clips, folder),
        }
        events = sum(len(each) for number in range(args.clips) for each in clips.clip(0, number).events)
        sys.stdout.write(f"{args.clips} clips of {events / args.clips:.0f} events" + "\n")
        for way, run in ways.items():
            sys.stdout.write(f"{way}: {clips_per_cpu_second(run):.1f} clips per second and core" + "\n")
        for file in sorted(folder.iterdir()):
            sys.stdout.write(f"{file.name}: {file.stat().st_size / args.clips / 1e6:.2f} MB a clip" + "\n")


if __name__ == "__main__":
    main()
