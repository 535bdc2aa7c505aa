"""The study with label images: networks learn classes from simulated events, and are tested on real ones."""

import argparse
import json
import sys

import numpy as np

from voltcam_client.errors import VoltcamError
from voltcam_video import SourceError

from . import labelled
from .clips import Clips
from .contenders import MODELS, sensor_of
from .results import folder_of
from .training import Budget, trained

CLIPS_SEED = 1


def run(args: argparse.Namespace) -> int:
    """Prints a line for each network, and writes segmentation.jsonl into `--work`; the exit status."""
    try:
        if args.labelled_test is None:
            raise ValueError("give --labelled-test, a folder with a real camera's events and label images")
        seen, test = labelled.read(args.labelled), labelled.read(args.labelled_test)
        of_camera = labelled.of_camera(test)
        clips = {name: _clips(name, seen, args) for name in MODELS}
    except (ValueError, OSError, SourceError, VoltcamError) as error:
        sys.stderr.write(f"{error}\n")
        return 1
    classes = max(seen.classes, test.classes)
    args.work.mkdir(parents=True, exist_ok=True)
    with (args.work / "segmentation.jsonl").open("w") as results:
        for seed in range(args.seeds):
            for name in MODELS:
                kept = folder_of(args.work, name) / f"segmentation_{seed}.pt"
                budget = Budget(steps=args.steps)
                network = trained(clips[name], budget, seed, kept, labelled.loss, classes).network
                union, right = labelled.intersection_over_union(network, of_camera, test)
                line = {"model": name, "seed": seed, "mean_iou": union, "accuracy": right}
                results.write(json.dumps(line) + "\n")
                sys.stdout.write(f"{name}, seed {seed}: mean IoU {union:.3f}, accuracy {right:.3f}\n")
    return 0


def _clips(name: str, seen: labelled.Labelled, args: argparse.Namespace) -> Clips:
    height, width = seen.frames.shape[1:]
    model = sensor_of(name)(width, height, 1.0, np.random.default_rng(CLIPS_SEED))
    return labelled.clips_of(labelled.simulated(model, seen), seen.labels, args.clips, args.size, CLIPS_SEED)
