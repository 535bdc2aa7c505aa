"""What the campaign for data sets is made of: short videos, photographs where nobody has any, and a spec."""

from pathlib import Path

import cv2
import numpy as np
import yaml

from voltcam_video.sources.scene import render

FRAMES, FPS, SIZE = 12, 30, (240, 180)


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
