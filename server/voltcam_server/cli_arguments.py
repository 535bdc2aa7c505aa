"""Arguments of the camera and its picture, and what a command line comes to in the config file's layout."""

import argparse
from typing import Any, get_args

from voltcam_simulator import Device, Law, camera_names
from voltcam_simulator.parameters import merged
from voltcam_video import Fit, Levels

from .settings import parse_change

CAMERA_HELP = f"{', '.join(camera_names())}, or a camera file (.yaml)"
DAVIS_OPTIONS = {"frames": "frames", "imu": "imu_hz", "triggers": "triggers_hz"}
SOURCE_FIELDS = ("fit", "levels", "width", "height", "fps", "pixel_format")


def add_camera(parser: argparse.ArgumentParser) -> None:
    camera = parser.add_argument_group("camera")
    camera.add_argument("--camera", metavar="NAME", help=f"{CAMERA_HELP} (default: davis346)")
    camera.add_argument("--law", choices=get_args(Law), help="when a pixel fires (default: exact)")
    camera.add_argument(
        "--device", choices=get_args(Device), help="cpu, or cuda: a GPU (voltcam[cuda]; default: cpu)"
    )
    camera.add_argument(
        "--seed", metavar="N", help="the same seed and frames give the same events (default: 0)"
    )
    camera.add_argument(
        "--upsample",
        metavar="HOW",
        help="frames between frames: linear, cubic, auto (along the motion, in steps below a pixel) or a "
        "number of steps (default: off, which is linear in serve and cubic in convert)",
    )
    camera.add_argument(
        "--set",
        metavar="EFFECT.NAME=VALUE",
        action="append",
        default=[],
        help="change a parameter, such as comparator.theta_on=1.2; may be given again",
    )


def add_picture(parser: Any) -> None:
    parser.add_argument(
        "--fit",
        choices=get_args(Fit),
        help="frames of other proportions: edges cut off, black bars, or out of proportion (default: crop)",
    )
    parser.add_argument(
        "--levels",
        choices=get_args(Levels),
        help="what grey levels are: light, or video, coded for screens (default: as usual for such a source)",
    )


def given_by(args: argparse.Namespace) -> dict[str, Any]:
    """What the command line says, in the config file's layout."""
    given = {key: value for key, value in vars(args).items() if value is not None}
    content: dict[str, Any] = {
        key: given[key]
        for key in (
            "camera",
            "law",
            "device",
            "seed",
            "upsample",
            "http",
            "zmq",
            "dv",
            "udp",
            "foxglove",
            "ros2",
            "ros2_messages",
            "camera_info",
            "encoding",
        )
        if key in given
    }
    source = {key: given[key] for key in SOURCE_FIELDS if key in given}
    for key in ("source", "input"):
        if key in given:
            source["uri"] = given[key]
    if "loop" in given:
        source["loop"] = True
    if "fast" in given or "input" in given:
        source["pace"] = "fast"
    if source:
        content["source"] = source
    davis = {name: given[key] for key, name in DAVIS_OPTIONS.items() if key in given}
    if davis:
        content["davis"] = davis
    if "burst" in given:
        content["packets"] = {"smooth": False}
    for text in args.set:
        content = merged(content, {"parameters": parse_change(text)})
    return content
