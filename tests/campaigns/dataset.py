"""`make dataset-campaign CLIPS=n`: a set of n short clips, videos and scenes of photographs, on two cores.

It fails when the single conversions together take less than LEAST_SHARE of the set's time on the processor,
which other programs do not change; when a worker's memory grows by more than GROWTH_MB in the last quarter,
or a process's by as much while it makes SINGLE items for the second time; when a set that was killed twice
and resumed, or one from a Dask cluster of which a worker is killed, is not the same to the bit; or when h5py
in a fresh process, and tonic where TONIC names a Python that has it, read other events than the manifest
says.
"""

import argparse
import contextlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import psutil
import yaml
from numpy.typing import NDArray

from voltcam_server.dataset.clips import Item, clips_of, items_of
from voltcam_server.dataset.item import Making, make_item
from voltcam_server.dataset.manifest import read_manifest
from voltcam_server.dataset.spec import Spec, load_spec
from voltcam_video.sources.scene import render

WORKERS = 2
LEAST_SHARE = 0.9
GROWTH_MB = 30.0
FRAMES, FPS, SIZE = 12, 30, (240, 180)
SINGLE = 40  # conversions one by one, spread over all
JUDGED = 400  # clips; with fewer, the start of the processes is most of the time, and of the memory
LIMIT_S = 7200

READ = """
import json, sys, h5py, hdf5plugin
count = 0
for line in open(sys.argv[1] + "/manifest.jsonl"):
    record = json.loads(line)
    with h5py.File(sys.argv[1] + "/" + record["path"]) as file:
        assert file["events/t"].shape == (record["events"],), record["path"]
        assert int(file["events/p"][:].sum()) == record["on"], record["path"]
        assert file["frames"].shape == (record["frames"], record["height"], record["width"])
        count += record["events"]
print(count)
"""

TONIC = """
import json, sys, hdf5plugin
from pathlib import Path
from tonic.datasets import DSEC
DSEC.__init__ = lambda self: None
root, count = Path(sys.argv[2]), 0
for line in list(open(sys.argv[1] + "/manifest.jsonl"))[::50]:
    record = json.loads(line)
    name = "item" + str(count)
    folder = root / name / "events_left"
    folder.mkdir(parents=True)
    (folder / "events.h5").symlink_to(Path(sys.argv[1], record["path"]).absolute())
    data = DSEC()
    data.location_on_system, data.split = str(root), "train"
    data.recording_selection, data.data_selection, data.target_selection = [name], ["events_left"], []
    data.transform = data.target_transform = data.transforms = None
    events = data[0][0][0]["events_left"]
    assert len(events) == record["events"] and int(events["p"].sum()) == record["on"]
    count += 1
print(count)
"""


def inputs(folder: Path, count: int, photographs: Path) -> Path:
    """Half of the clips, and a spec of all."""
    (folder / "videos").mkdir(parents=True)
    for number in range(count // 2):
        path = str(folder / "videos" / f"clip{number:05}.mp4")
        video = cv2.VideoWriter(path, cv2.VideoWriter.fourcc(*"mp4v"), FPS, SIZE)
        for i in range(FRAMES):
            image = render(137_000 * number + round(1e6 / FPS * i), *SIZE)
            video.write(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR))
        video.release()
    spec = {
        "inputs": [
            f"{folder}/videos/*.mp4",
            {"files": str(photographs), "scenes": count - count // 2, "fps": FPS},
        ],
        "camera": "davis240c",
        "parameters": {
            "comparator": {"theta_on": {"uniform": [0.8, 1.2]}, "theta_off": {"uniform": [0.8, 1.2]}},
            "junction_leak": {"k4_per_us": {"log_uniform": [1e-9, 1e-6]}},
        },
        "seconds": (FRAMES - 0.5) / FPS,
        "shard": 100,
    }
    (folder / "spec.yaml").write_text(yaml.safe_dump(spec))
    return folder / "spec.yaml"


def photographs(folder: Path) -> Path:
    """Where nobody has any: coarse noise in colour."""
    folder.mkdir(parents=True)
    generator = np.random.default_rng(1)
    for number in range(8):
        noise = generator.integers(0, 255, (60, 80, 3), np.uint8)
        cv2.imwrite(
            str(folder / f"{number}.jpg"), cv2.resize(noise, (1280, 960), interpolation=cv2.INTER_CUBIC)
        )
    return folder


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


class Watch:
    """mb: the most that one worker of a process has, as time goes on. cpu_s: of it and of each worker."""

    def __init__(self, pid: int) -> None:
        self.mb: list[float] = []
        self.cpu_s: dict[int, float] = {}
        self._process, self._done = psutil.Process(pid), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def growth_mb(self) -> float:
        """Of the last quarter over the one before, in the median: items of a kind come together, and a single
        large one is no growth."""
        self._done.set()
        self._thread.join(10)
        quarter = len(self.mb) // 4
        if quarter == 0:
            return 0.0
        return float(np.median(self.mb[3 * quarter :]) - np.median(self.mb[2 * quarter : 3 * quarter]))

    def _run(self) -> None:
        while not self._done.wait(0.5):
            with contextlib.suppress(psutil.Error, ValueError):
                workers = self._process.children(recursive=True)
                for one in (self._process, *workers):
                    self.cpu_s[one.pid] = sum(one.cpu_times()[:2])
                self.mb.append(max(worker.memory_info().rss for worker in workers) / 1e6)


def command(spec: Path, out: Path, *more: str) -> list[str]:
    voltcam = "import sys; from voltcam_client.cli import main; sys.exit(main())"
    return [sys.executable, "-c", voltcam, "dataset", "make", str(spec), str(out), *more]


def once(spec: Path, out: Path, *more: str) -> tuple[float, Watch]:
    """Make a set; how long it took from the start of the command to its end."""
    began_s = time.monotonic()
    with subprocess.Popen(command(spec, out, *more), stdout=subprocess.PIPE, text=True) as process:
        watch = Watch(process.pid)
        said, _ = process.communicate(timeout=LIMIT_S)
    assert process.returncode == 0, said
    return time.monotonic() - began_s, watch


def killed_twice(spec: Path, out: Path, count: int) -> list[int]:
    """By SIGKILL, and by Ctrl-C; then made to its end. How many items there were each time."""
    found = []
    for part, number in ((0.3, signal.SIGKILL), (0.6, signal.SIGINT)):
        process = subprocess.Popen(command(spec, out, "--workers", str(WORKERS)), start_new_session=True)
        until_s = time.monotonic() + LIMIT_S
        while lines(out) < part * count and time.monotonic() < until_s:
            time.sleep(0.1)
        if number == signal.SIGKILL:
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)
        process.wait(LIMIT_S)
        found.append(lines(out))
    once(spec, out, "--workers", str(WORKERS))
    return found


def lines(out: Path) -> int:
    path = out / "manifest.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


@contextlib.contextmanager
def cluster(folder: Path) -> Iterator[str]:
    """A scheduler and two workers on loopback; one is killed after a while."""
    port = random.Random(os.getpid()).randrange(40_000, 60_000)
    dask = [sys.executable, "-m", "dask"]
    log = (folder / "cluster.log").open("w")
    start = partial(subprocess.Popen, stdout=log, stderr=log, start_new_session=True)
    processes = [
        start([*dask, "scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]),
        start(
            [
                *dask, "worker", f"tcp://127.0.0.1:{port}", "--nworkers", str(WORKERS), "--nthreads", "1",
                "--no-dashboard", "--local-directory", str(folder),
            ]
        ),
    ]  # fmt: skip
    try:
        time.sleep(8)
        yield f"dask://127.0.0.1:{port}"
    finally:
        for process in processes:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        log.close()


def on_cluster(spec: Path, out: Path, folder: Path, count: int) -> float:
    """Kills the process of a worker in the middle. Seconds."""
    with cluster(folder) as address:
        began_s = time.monotonic()
        process = subprocess.Popen(command(spec, out, "--engine", address))
        while lines(out) < 0.4 * count and process.poll() is None:
            time.sleep(0.1)
        workers = [
            one for one in psutil.process_iter(["cmdline"])
            if str(folder) in " ".join(one.info["cmdline"] or []) or "distributed.nanny" in str(one.info)
        ]  # fmt: skip
        spawned = [
            child for one in workers for child in one.children() if "spawn_main" in str(child.cmdline())
        ]
        assert spawned, "no worker was found"
        spawned[0].kill()
        assert process.wait(LIMIT_S) == 0
        return time.monotonic() - began_s


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
