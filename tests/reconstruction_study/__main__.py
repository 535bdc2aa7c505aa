"""Runs the study, and writes its page; it goes on where it was interrupted."""

import argparse
import json
import logging
import os
import platform
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np
import torch

from . import clips, page, real, segmentation
from .contenders import ABLATIONS, MODELS
from .results import folder_of
from .training import Budget, trained

ROOT = Path(__file__).parents[2]
CLIPS_SEED = 1


def arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.reconstruction_study", description=__doc__)
    parser.add_argument("--photographs", type=Path, help="a folder of photographs")
    parser.add_argument(
        "--data",
        type=Path,
        default=os.environ.get("VOLTCAM_DATA"),
        help="the folder of recordings (VOLTCAM_DATA)",
    )
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "reconstruction-study")
    parser.add_argument(
        "--page", type=Path, default=ROOT / "docs" / "how-it-works" / "reconstruction-study.md"
    )
    parser.add_argument("--clips", type=int, default=160, help="for each model (default: 160)")
    parser.add_argument("--size", type=int, default=64, help="of a clip, pixels (default: 64)")
    parser.add_argument("--steps", type=int, default=200, help="of training (default: 200)")
    parser.add_argument("--seeds", type=int, default=3, help="networks for each model (default: 3)")
    parser.add_argument("--threads", type=int, default=1, help="cores (default: 1)")
    parser.add_argument("--ablation", action="store_true", help="also without one effect at a time")
    parser.add_argument("--only-page", action="store_true", help="train nothing, write what there is")
    labels = parser.add_argument_group("segmentation instead, as the paper's Table 1 (see labelled.py)")
    labels.add_argument("--labelled", type=Path, help="a folder of frames with label images, to train on")
    labels.add_argument("--labelled-test", type=Path, help="the same with a real camera's events.txt")
    return parser


def main() -> int:
    parser = arguments()
    args = parser.parse_args()
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(message)s")
    if args.labelled is not None:
        return segmentation.run(args)
    if args.photographs is None:
        parser.error("no photographs: give --photographs, a folder")
    if args.data is None or not (args.data / "slider_depth").is_dir():
        parser.error("no recordings: give --data, or VOLTCAM_DATA, a folder with slider_depth")
    torch.set_num_threads(args.threads)
    recordings = real.recordings(args.data)
    if not args.only_page:
        names = MODELS + (ABLATIONS if args.ablation else ())
        for seed in range(args.seeds):
            for name in names:
                _run(args, name, seed, recordings)
    page.write(args.page, args.work, recordings)
    return 0


def machine() -> str:
    """The processor and PyTorch, in words."""
    info = Path("/proc/cpuinfo")
    names = (
        [line.partition(":")[2].strip() for line in info.read_text().splitlines() if "model name" in line]
        if info.exists()
        else []
    )
    return f"{names[0] if names else platform.machine()}, PyTorch {torch.__version__}"


def _run(args: argparse.Namespace, name: str, seed: int, recordings: list[real.Real]) -> None:
    folder = folder_of(args.work, name)
    result = folder / f"seed_{seed}.json"
    if result.exists():
        return
    made = clips.made(name, args.photographs, args.clips, args.size, CLIPS_SEED, folder / "clips.pt")
    budget = Budget(steps=args.steps)
    one = trained(made, budget, seed, folder / f"seed_{seed}.pt")
    content = {
        "model": name,
        "seed": seed,
        "budget": asdict(budget)
        | {
            "clips": args.clips,
            "size": args.size,
            "windows": clips.WINDOWS,
            "threads": args.threads,
        },
        "events": made.events,
        "took_s": one.took_s,
        "losses": one.losses,
        "measured": {},
        "machine": machine(),
    }
    for recording in recordings:
        images = real.reconstructed(one.network, recording)
        content["measured"][recording.name] = asdict(real.measured(images, recording))
        if seed == 0:
            np.save(folder / f"{recording.name}.npy", images[-1].astype(np.float32))
    result.write_text(json.dumps(content))
    logging.info("%s, seed %d: %s", name, seed, content["measured"])


if __name__ == "__main__":
    sys.exit(main())
