"""`voltcam replay`: a recording as a live camera, or its events made again to verify them."""

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

from voltcam_client.cli_arguments import seconds
from voltcam_client.formats import read
from voltcam_simulator import Camera

from .cli_serve import run_daemon
from .replay_source import SCHEME
from .verify import verify


def configure(parser: argparse.ArgumentParser) -> None:
    """Arguments of `voltcam replay`."""
    parser.description = (
        "Play a recording as a live camera: its own events and frames at their own pace, over ZeroMQ and "
        "WebSocket, with the page. Or make its events again from its frames, and compare."
    )
    parser.epilog = """\
examples:
  voltcam replay walk.npz                     then, elsewhere: voltcam listen
  voltcam replay walk.aedat4 --loop --start 12.5
  voltcam replay walk.npz --verify            needs the manifest that the daemon has written beside it

While it runs, PUT /api/v1/source with "start_s" goes to another place, as the page does."""
    parser.add_argument("file", metavar="FILE", type=Path, help="a recording")
    parser.add_argument(
        "--verify", action="store_true", help="make the events again, and compare bit for bit"
    )
    parser.add_argument("--loop", action="store_true", help="again and again")
    parser.add_argument("--start", metavar="S", type=seconds, help="begin so many seconds after its start")
    parser.add_argument(
        "--http", metavar="HOST:PORT", help="page, REST and WebSocket (default: 127.0.0.1:8560)"
    )
    parser.add_argument("--zmq", metavar="ENDPOINT", help="ZeroMQ (default: tcp://127.0.0.1:5560)")
    parser.add_argument("--dv", metavar="HOST:PORT", help="DV streams, or off (default: 127.0.0.1:7777)")
    parser.add_argument("--ros2", metavar="NAMESPACE", help="topics of ROS 2 (default: off)")
    parser.set_defaults(run=_run)


def _run(args: argparse.Namespace) -> int:
    if args.verify:
        verdict = verify(args.file)
        sys.stdout.write(f"{args.file}: {verdict.words}\n")
        return 1 if verdict.difference else 0
    recording = read(args.file)
    camera = Camera(name=args.file.stem, width=recording.width, height=recording.height)
    del recording  # it may be large
    source: dict[str, Any] = {"uri": f"{SCHEME}{args.file.absolute()}", "loop": args.loop}
    if args.start:
        source["start_s"] = args.start
    given = {key: value for key in ("http", "zmq", "dv", "ros2") if (value := getattr(args, key)) is not None}
    with tempfile.TemporaryDirectory(prefix="voltcam-replay-") as folder:
        file = Path(folder) / "camera.yaml"
        file.write_text(camera.to_yaml())
        return run_daemon({"camera": str(file), "source": source, **given}, None, None)
