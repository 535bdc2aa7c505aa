"""`make dataset-campaign CLIPS=n`: a set of n short clips, videos and scenes of photographs, on two cores.

It fails when the single conversions together take less than LEAST_SHARE of the set's time on the processor,
which other programs do not change; when a worker's memory grows by more than GROWTH_MB in the last quarter,
or a process's by as much while it makes SINGLE items for the second time; when a set that was killed twice
and resumed, or one from a Dask cluster of which a worker is killed, is not the same to the bit; or when h5py
in a fresh process, and tonic where TONIC names a Python that has it, read other events than the manifest
says.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np
import psutil
from numpy.typing import NDArray

from voltcam_server.dataset.clips import Item, clips_of, items_of
from voltcam_server.dataset.item import Making, make_item
from voltcam_server.dataset.manifest import read_manifest
from voltcam_server.dataset.spec import Spec, load_spec

from .dataset_inputs import inputs, photographs
from .dataset_readers import READ, TONIC
from .dataset_runs import WORKERS, command, killed_twice, on_cluster, once

LEAST_SHARE = 0.9
GROWTH_MB = 30.0
SINGLE = 40  # conversions one by one, spread over all
JUDGED = 400  # clips; with fewer, the start of the processes is most of the time, and of the memory


def one_by_one(spec: Spec, out: Path, first: int) -> NDArray[np.float64]:
    """Seconds by the clock, and of the processor, that all the conversions take, by SINGLE of them."""
    cv2.setNumThreads(0)
    os.environ["BLOSC_NTHREADS"] = "1"
    items = items_of(spec, clips_of(spec))
    making = Making(out, spec.cameras(), spec.law, spec.device, "cubic", spec.fit, spec.seconds, spec.frames)
    chosen: list[Item] = items[first :: max(1, len(items) // SINGLE)]
    for kind in (items[0], items[-1]):
        make_item(kind, making)  # kernels are loaded
    began = np.array([time.monotonic(), time.process_time()])
    for item in chosen:
        outcome = make_item(item, making)
        assert outcome.failed is None, outcome.failed
    took = np.array([time.monotonic(), time.process_time()]) - began
    return took / len(chosen) * len(items)


def own_mb() -> float:
    """Memory of this process."""
    return psutil.Process().memory_info().rss / 1e6


def same(one: Path, other: Path) -> bool:
    names = [sorted(str(path.relative_to(each)) for path in each.rglob("*")) for each in (one, other)]
    return names[0] == names[1] and all(
        (one / name).read_bytes() == (other / name).read_bytes()
        for name in names[0]
        if (one / name).is_file()
    )


def main() -> int:
    """Run the campaign; returns 1 where something did not hold."""
    parser = argparse.ArgumentParser(prog="make dataset-campaign", description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--photographs", type=Path, help="a folder of such; none: noise")
    parser.add_argument("--tonic", type=Path, help="a Python that has tonic")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="voltcam-dataset-") as name:
        faults = campaign(Path(name), args.count, args.photographs, args.tonic)
    sys.stdout.write("".join(f"FAILED: {fault}\n" for fault in faults))
    return 1 if faults else 0


def campaign(folder: Path, count: int, own: Path | None, tonic: Path | None) -> list[str]:
    faults: list[str] = []
    spec = inputs(folder, count, own or photographs(folder / "photographs"))
    whole = folder / "whole"

    def tell(what: str, good: bool = True) -> None:
        sys.stdout.write(("" if good else "NOT: ") + what + "\n")
        sys.stdout.flush()
        faults.extend([] if good else [what])

    # Before and after: a machine with other work on it is not always as fast.
    before = one_by_one(load_spec(spec), folder / "single", 0)
    took_s, watch = once(spec, whole, "--workers", str(WORKERS))
    first_mb = own_mb()
    alone_s, alone_cpu_s = (before + one_by_one(load_spec(spec), folder / "single", 1)) / 2
    again_mb = own_mb() - first_mb
    share = alone_s / WORKERS / took_s
    cpu_s = sum(watch.cpu_s.values())
    cpu_share = alone_cpu_s / cpu_s
    events = sum(record["events"] for record in read_manifest(whole))
    tell(
        f"{count} clips, {events / 1e6:.0f} M events: {took_s:.0f} s on {WORKERS} workers, {alone_s:.0f} s "
        f"one by one: {share:.2f} of their throughput, start-up included"
    )
    tell(
        f"of the processor {cpu_s:.0f} s, {alone_cpu_s:.0f} s one by one: {cpu_share:.2f}, start-up included",
        cpu_share >= LEAST_SHARE or count < JUDGED,
    )
    growth_mb = watch.growth_mb()
    tell(
        f"memory of a worker {max(watch.mb, default=0):.0f} MB, growth {growth_mb:+.1f} MB",
        growth_mb < GROWTH_MB or count < JUDGED,
    )
    tell(f"growth of one process by {SINGLE} items more {again_mb:+.1f} MB", again_mb < GROWTH_MB)
    there = killed_twice(spec, folder / "killed", count)
    tell(
        f"killed with {there[0]} and stopped with {there[1]} items, resumed: the same",
        same(whole, folder / "killed"),
    )
    shutil.rmtree(folder / "killed")
    far_s = on_cluster(spec, folder / "far", folder, count)
    tell(f"on a cluster, a worker killed: {far_s:.0f} s, the same", same(whole, folder / "far"))
    read = subprocess.run([sys.executable, "-c", READ, str(whole)], capture_output=True, text=True)
    tell(f"h5py in a fresh process read {read.stdout.strip()} events", read.stdout.strip() == str(events))
    if tonic is not None:
        seen = subprocess.run(
            [str(tonic), "-c", TONIC, str(whole), str(folder / "tonic")], capture_output=True, text=True
        )
        tell(f"tonic read {seen.stdout.strip()} items{seen.stderr[-300:]}", seen.returncode == 0)
    checked = subprocess.run(
        [*command(spec, whole)[:3], "dataset", "check", str(whole)], capture_output=True, text=True
    )
    tell(checked.stdout.strip().replace(str(folder), ""), checked.returncode == 0)
    return faults


if __name__ == "__main__":
    sys.exit(main())
