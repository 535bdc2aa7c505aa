"""The commands of the server, `voltcam serve`, `convert` and `schema`: arguments, and words for the user."""

import argparse
import json
import sys
from functools import partial
from pathlib import Path
from typing import Any, get_args

from voltcam_client.cli_arguments import seconds
from voltcam_client.formats import SUFFIXES
from voltcam_client.formats.ros_messages import EventsAs
from voltcam_simulator import Device, Law, camera_names
from voltcam_simulator.parameters import merged
from voltcam_video import Fit, Levels

from .beside import Frames
from .camera_settings import EncodingName
from .log import begin_log
from .settings import load, parse_change
from .settings import schema as config_schema

CAMERA_HELP = f"{', '.join(camera_names())}, or a camera file (.yaml)"
DAVIS_OPTIONS = {"frames": "frames", "imu": "imu_hz", "triggers": "triggers_hz"}
BANNER = {
    "zeromq": ("events", "{}", "to see them: voltcam listen {}"),
    "dv": ("DV", "{}", "for dv-processing"),
    "udp": ("UDP", "{}", "events are sent there, to whoever listens"),
    "foxglove": ("Foxglove", "{}", "in Foxglove: Open connection, Foxglove WebSocket"),
    "ros2": ("ROS 2", "{}/events", "ros2 topic hz {}"),
}
"""What `voltcam serve` says of each transport: its name, its address, and what to do with it."""
SOURCE_FIELDS = ("fit", "levels", "width", "height", "fps", "pixel_format")


def serve(parser: argparse.ArgumentParser) -> None:
    """Arguments of `voltcam serve`."""
    parser.description = (
        "Run the camera: live video in, events out over ZeroMQ, WebSocket, DV and ROS 2, a page to watch."
    )
    parser.epilog = """\
All but --record can also be in the config file and in the environment (VOLTCAM_LAW, VOLTCAM_SOURCE__URI,
VOLTCAM_PARAMETERS__COMPARATOR__THETA_ON); the command line comes first, then the environment, then the
file. `voltcam schema` describes the file for editors.

examples:
  voltcam serve                                     the built-in moving scene
  voltcam serve --source 0 --width 640 --height 480 --pixel-format MJPG
  voltcam serve --source street.mp4 --loop --set comparator.theta_on=1.2 --set temperature_c=40
  voltcam serve --source rtsp://robot.local/front --config robot.yaml"""
    parser.add_argument("--config", metavar="FILE", type=Path, help="a YAML file with settings")
    _add_camera(parser)
    source = parser.add_argument_group("source")
    source.add_argument(
        "--source",
        metavar="URI",
        help="scene (built in), a camera (0 or /dev/video0), a video file, a folder with images.txt, "
        "an .npz, a stream (rtsp://, http://, udp://), ros1:TOPIC, or photos:FOLDER",
    )
    source.add_argument("--loop", action="store_true", default=None, help="play a recording again and again")
    source.add_argument(
        "--fast", action="store_true", default=None, help="play a recording as fast as the simulation goes"
    )
    _add_picture(source)
    source.add_argument("--width", metavar="PIXELS", help="asked of a camera or the scene")
    source.add_argument("--height", metavar="PIXELS", help="asked of a camera or the scene")
    source.add_argument("--fps", metavar="N", help="frames per second, asked of a camera or the scene")
    source.add_argument("--pixel-format", metavar="FOURCC", help="asked of a camera: MJPG, YUYV, GREY...")
    out = parser.add_argument_group("output")
    out.add_argument("--http", metavar="HOST:PORT", help="page, REST and WebSocket (default: 127.0.0.1:8560)")
    out.add_argument("--zmq", metavar="ENDPOINT", help="ZeroMQ (default: tcp://127.0.0.1:5560)")
    out.add_argument(
        "--dv",
        metavar="HOST:PORT",
        help="DV streams, for dv-processing: events there, frames on the next port; off: none "
        "(default: 127.0.0.1:7777)",
    )
    out.add_argument(
        "--udp",
        metavar="FORM://HOST:PORT",
        help="events as datagrams: spif for AEStream, t32_x16_y15_on1 for faery (default: off)",
    )
    out.add_argument(
        "--foxglove",
        metavar="HOST:PORT",
        help="frames and a preview of events for Foxglove, usually 127.0.0.1:8765 (default: off)",
    )
    out.add_argument(
        "--ros2",
        metavar="NAMESPACE",
        help="topics of ROS 2: NAMESPACE/events, image_raw, camera_info, imu; needs voltcam[ros2] "
        "(default: off)",
    )
    out.add_argument(
        "--ros2-messages",
        choices=get_args(EventsAs),
        help="events there as event_camera_msgs/EventPacket (packet, the default) or dvs_msgs/EventArray",
    )
    out.add_argument(
        "--camera-info",
        metavar="FILE.yaml",
        help="intrinsics for ROS 2, as camera_calibration writes them",
    )
    out.add_argument(
        "--frames",
        choices=get_args(Frames),
        help="those of the source, or as a DAVIS exposes them, at the times of the effect aps_coupling "
        "(default: source)",
    )
    out.add_argument("--imu", metavar="HZ", help="samples per second of an IMU at rest (default: none)")
    out.add_argument(
        "--triggers", metavar="HZ", help="a square wave of so many Hz at the trigger input (default: none)"
    )
    out.add_argument("--encoding", choices=get_args(EncodingName), help="of event packets (default: libcaer)")
    out.add_argument(
        "--burst",
        action="store_true",
        default=None,
        help="send the events of a frame interval at once, not at their own pace over the next one",
    )
    out.add_argument("--record", metavar="FILE", help="record events and frames from the start")
    parser.set_defaults(run=_serve)


def convert(parser: argparse.ArgumentParser) -> None:
    """Arguments of `voltcam convert`."""
    formats = "\n".join(f"  {suffix:<10} {description}" for suffix, description in SUFFIXES.items())
    parser.description = "Turn frames into an event file: as fast as possible, no frame left out."
    parser.epilog = f"""\
INPUT is a video, a folder with images.txt (the Event Camera Dataset's layout), an .npz with frames and t_us,
or, with --seconds, a camera, a stream or photos:FOLDER. A recording without frames is copied.

formats, by the suffix of OUTPUT:
{formats}

examples:
  voltcam convert street.mp4 street.npz
  voltcam convert slider_depth slider.txt --camera davis240c --seed 1 --set temperature_c=40
  voltcam convert rtsp://robot.local/front run.raw --seconds 60

What was written is kept, and reads as it is, after an error or Ctrl-C."""
    parser.add_argument("input", metavar="INPUT", help="what to read")
    parser.add_argument("output", metavar="OUTPUT", type=Path, help="the file to write")
    _add_camera(parser)
    _add_picture(parser)
    parser.add_argument(
        "--seconds", metavar="N", type=seconds, help="end after N seconds of the input's time"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace OUTPUT if it exists")
    parser.add_argument(
        "--copy",
        action="store_true",
        help="copy a recording's events and frames; without it its frames are simulated anew",
    )
    parser.add_argument("--fps", metavar="N", help="frames per second, of the scene and of photographs")
    parser.add_argument(
        "--truth",
        metavar="FILE.h5",
        type=Path,
        help="of photos:FOLDER: write light, flow and depth order of each frame",
    )
    parser.set_defaults(run=_convert)


def schema(parser: argparse.ArgumentParser) -> None:
    """Arguments of `voltcam schema`."""
    parser.epilog = """\
example:
  voltcam schema > voltcam.schema.json
  and as the first line of the config file:  # yaml-language-server: $schema=voltcam.schema.json"""
    parser.set_defaults(run=_schema)


def _add_camera(parser: argparse.ArgumentParser) -> None:
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


def _add_picture(parser: Any) -> None:
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


def _serve(args: argparse.Namespace) -> int:
    return run_daemon(_given(args), args.config, args.record)


def run_daemon(given: dict[str, Any], config: Path | None, record: str | None) -> int:
    """The daemon with what the command line says, in the config file's layout; returns the exit status."""
    from .daemon import serve as run

    read = partial(load, given, config)
    settings = read()
    begin_log(settings.log)
    for name, each in settings.each().items():
        print(f"voltcam: {name} looking at {each.source.shown} ...", flush=True)

    def banner(page: str, cameras: dict[str, dict[str, str]]) -> None:
        print(f"  page      {page}")
        for name, addresses in cameras.items():
            whose = f"of {name}; " if settings.cameras else ""
            for transport, (label, shown, remark) in BANNER.items():
                if transport in addresses:
                    at = shown.format(addresses[transport])
                    print(f"  {label:<8}  {at}  ({whose}{remark.format(at)})")
        print("  Ctrl-C ends it", flush=True)

    run(settings, record, banner, read)
    return 0


def _convert(args: argparse.Namespace) -> int:
    from .convert import Conversion
    from .convert import convert as run

    settings = load(_given(args), environment={})
    job = Conversion(
        source=settings.source,
        camera=settings.load_camera(),
        output=args.output,
        law=settings.law,
        device=settings.device,
        seed=settings.seed,
        upsample="cubic" if settings.upsample == "off" else settings.upsample,
        seconds=args.seconds,
        overwrite=args.overwrite,
        copy=args.copy,
        truth=args.truth,
    )
    print(run(job))
    return 0


def _schema(_: argparse.Namespace) -> int:
    json.dump(config_schema(), sys.stdout, indent=2)
    print()
    return 0


def _given(args: argparse.Namespace) -> dict[str, Any]:
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
