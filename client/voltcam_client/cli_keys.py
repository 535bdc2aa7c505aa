"""`voltcam keys`: the keys that open a camera's stream to few."""

import argparse
from pathlib import Path

from voltcam_client.keys import make_keys


def configure(parser: argparse.ArgumentParser) -> None:
    parser.description = "Make the keys with which a camera's ZeroMQ stream is encrypted, and open to few."
    parser.epilog = """\
examples:
  voltcam keys /etc/voltcam/keys robot laptop   keys of the camera, and of two who may listen
then, in the camera's config file, `access: {curve_keys: /etc/voltcam/keys}`, and on the robot, with the
folder for-robot moved there:  VOLTCAM_KEYS=for-robot voltcam listen tcp://camera.local:5560"""
    parser.add_argument(
        "folder", metavar="FOLDER", type=Path, help="where the camera's keys are, or are to be"
    )
    parser.add_argument("clients", metavar="NAME", nargs="*", help="who may listen")
    parser.set_defaults(run=_keys)


def _keys(args: argparse.Namespace) -> int:
    for made in make_keys(args.folder, args.clients):
        print(f"{made}  (to be moved to that machine, and named there in VOLTCAM_KEYS)")
    print(f"{args.folder}  (access.curve_keys of the camera's config file)")
    return 0
