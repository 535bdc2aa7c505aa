"""`voltcam serve`: its arguments, and what it says once it runs."""

import argparse
from functools import partial
from pathlib import Path
from typing import Any, get_args

from voltcam_client.formats.ros_messages import EventsAs

from .beside import Frames
from .camera_settings import EncodingName
from .cli_arguments import add_camera, add_picture, given_by
from .log import begin_log
from .settings import load

BANNER = {
    "zeromq": ("events", "{}", "to see them: voltcam listen {}"),
    "dv": ("DV", "{}", "for dv-processing"),
    "udp": ("UDP", "{}", "events are sent there, to whoever listens"),
    "foxglove": ("Foxglove", "{}", "in Foxglove: Open connection, Foxglove WebSocket"),
    "ros2": ("ROS 2", "{}/events", "ros2 topic hz {}"),
}
"""What `voltcam serve` says of each transport: its name, its address, and what to do with it."""


def configure(parser: argparse.ArgumentParser) -> None:
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
    add_camera(parser)
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
    add_picture(source)
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
    parser.set_defaults(run=_run)


def _run(args: argparse.Namespace) -> int:
    return run_daemon(given_by(args), args.config, args.record)


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
