"""`voltcam ros1`: a running camera as topics of ROS 1."""

import argparse
import signal
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from voltcam_client import camera
from voltcam_client.camera import EventCamera
from voltcam_client.cli_arguments import URL_HELP
from voltcam_client.intrinsics import UNKNOWN_INTRINSICS, read_intrinsics
from voltcam_client.ros1.bridge import Bridge, BridgeSettings
from voltcam_client.ros1.names import Names
from voltcam_client.ros1.node import Node
from voltcam_client.terminal import until_signal


def configure(parser: argparse.ArgumentParser) -> None:
    parser.description = "Publish a running camera to ROS 1, as the driver of a DAVIS does, until Ctrl-C."
    parser.usage = "voltcam ros1 [-h] [options] [URL] [NAME:=VALUE ...]"
    parser.epilog = """\
topics:
  /dvs/events       event_camera_msgs/EventPacket, or dvs_msgs/EventArray
  /dvs/image_raw    sensor_msgs/Image, mono8; an APS frame's stamp is the middle of its exposure
  /dvs/camera_info  sensor_msgs/CameraInfo, with each image
  /dvs/imu          sensor_msgs/Imu, where the daemon has --imu

examples:
  voltcam ros1
  voltcam ros1 tcp://robot.local:5560 --messages array
  voltcam ros1 __ns:=/left dvs/events:=/dvs/left/events

It takes ROS_MASTER_URI, ROS_HOSTNAME, ROS_IP, ROS_NAMESPACE, and the arguments of roslaunch. It needs a
roscore somewhere, and no ROS on this machine."""
    parser.add_argument("url", metavar="URL", nargs="?", default=camera.DEFAULT_URL, help=URL_HELP)
    parser.add_argument("--namespace", metavar="NAME", default="dvs", help="of the topics (default: dvs)")
    parser.add_argument(
        "--messages",
        choices=("packet", "array"),
        default="packet",
        help="events as event_camera_msgs/EventPacket (default) or as dvs_msgs/EventArray, twice as large",
    )
    parser.add_argument(
        "--camera-info", metavar="FILE.yaml", type=Path, help="intrinsics, as camera_calibration writes them"
    )
    parser.add_argument("--frame-id", metavar="NAME", help="of all headers (default: the camera's name)")
    parser.add_argument(
        "--queue-size",
        metavar="N",
        type=_count,
        default=100,
        help="messages that wait for a subscriber (100)",
    )
    parser.add_argument("--clock", action="store_true", help="publish /clock, for a stream of simulated time")
    # `NAME:=VALUE` may stand anywhere, as for any node; argparse knows no such arguments.
    parse = parser.parse_known_args

    def parse_known_args(args: Sequence[str] | None = None, namespace: Any = None) -> Any:
        words = list(args or [])
        namespace, others = parse([word for word in words if ":=" not in word], namespace)
        namespace.remappings = [word for word in words if ":=" in word]
        return namespace, others

    parser.parse_known_args = parse_known_args  # type: ignore[method-assign,assignment]
    parser.set_defaults(run=_run)


def _count(text: str) -> int:
    number = int(text)
    if not 1 <= number <= 10_000:
        raise ValueError
    return number


def _run(args: argparse.Namespace) -> int:
    settings = BridgeSettings(
        namespace=args.namespace,
        events=args.messages,
        intrinsics=read_intrinsics(args.camera_info) if args.camera_info else UNKNOWN_INTRINSICS,
        frame_id=args.frame_id,
        queue_size=args.queue_size,
        clock=args.clock,
    )
    names = Names.of("voltcam", args.remappings)
    with (
        until_signal(signal.SIGINT, signal.SIGTERM) as stopped,
        EventCamera(args.url) as source,
        Node(names) as node,
    ):
        bridge = Bridge(node, source, settings)
        print(f"{names.node} publishes {args.url} below {names.resolved(args.namespace)}", flush=True)
        bridge.run(stopped.is_set)
    return 0
