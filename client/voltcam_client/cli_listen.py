"""`voltcam listen`: rates, losses and latency of a running camera."""

import argparse
import json
import math
import signal
import time
from dataclasses import asdict

from voltcam_client import camera
from voltcam_client.camera import EventCamera
from voltcam_client.cli_arguments import URL_HELP, seconds
from voltcam_client.meter import measure
from voltcam_client.terminal import until_signal


def configure(parser: argparse.ArgumentParser) -> None:
    parser.description = "Print what comes from a running camera, one line per second, until Ctrl-C."
    parser.epilog = """\
examples:
  voltcam listen                                   the camera on this machine
  voltcam listen tcp://robot.local:5560 --seconds 10
  voltcam listen --json | jq .events_per_s

The latency is this machine's clock less the camera's: synchronise the two before you trust it."""
    parser.add_argument("url", metavar="URL", nargs="?", default=camera.DEFAULT_URL, help=URL_HELP)
    parser.add_argument("--seconds", metavar="N", type=seconds, help="end after N seconds")
    parser.add_argument("--json", action="store_true", help="print a JSON object per line")
    parser.set_defaults(run=_listen)


def _listen(args: argparse.Namespace) -> int:
    end = time.monotonic() + (args.seconds or math.inf)
    heard = False
    # A flag, because the exception of Ctrl-C is lost if it meets a destructor.
    with EventCamera(args.url) as source, until_signal(signal.SIGINT) as stopped:
        while (left_s := end - time.monotonic()) > 0:
            rates = measure(source, min(1.0, left_s), stopped.is_set)
            if stopped.is_set():
                return 128 + signal.SIGINT
            heard = heard or rates.packets_per_s > 0
            print(json.dumps(asdict(rates)) if args.json else rates, flush=True)
    if not heard:
        raise TimeoutError(f"nothing came from {args.url}: is `voltcam serve` running there?")
    return 0
