"""`voltcam biases`: the bias currents of a running camera, by the names that drivers of a DAVIS have."""

import argparse
from pathlib import Path

from voltcam_client import control
from voltcam_client.errors import VoltcamError

MOST_BYTES = 65536


def configure(parser: argparse.ArgumentParser) -> None:
    parser.description = "Print the biases of a running camera, or set, load or save them."
    parser.epilog = """\
examples:
  voltcam biases                                  print them all
  voltcam biases ONBn_fine=120 RefrBp_coarse=5    less contrast, shorter dead time
  voltcam biases --save dim.yaml                  keep them
  voltcam biases --load dim.yaml                  and set them again; a file of a ROS driver will do
  voltcam biases --load dim.yaml PrBp_fine=90     one other than there
What each does: the page "Biases of a DAVIS" of the documentation, or /api/v1/docs of the daemon."""
    default = control.DEFAULT_URL
    parser.add_argument("changes", metavar="NAME=NUMBER", nargs="*", help="a bias to set")
    parser.add_argument("--url", default=default, help=f"where the daemon is (default: {default})")
    parser.add_argument("--camera", help="which, of a daemon that has several")
    parser.add_argument(
        "--load", type=Path, metavar="FILE", help="set those in the file: `NAME: NUMBER` a line"
    )
    parser.add_argument("--save", type=Path, metavar="FILE", help="write all of them, after what is set")
    parser.set_defaults(run=_biases)


def _biases(args: argparse.Namespace) -> int:
    changes = read_biases(args.load) if args.load else {}
    changes |= dict(_given(word) for word in args.changes)
    daemon = control.Control(args.url, camera=args.camera)
    biases = daemon.set_biases(changes) if changes else daemon.biases()
    text = "".join(f"{name}: {value}\n" for name, value in biases.items())
    if args.save:
        args.save.write_text(text)
    else:
        print(text, end="")
    return 0


def read_biases(path: Path) -> dict[str, int]:
    """The biases of a file: `NAME: NUMBER` a line, other lines and `#` comments left out, as ROS drivers'
    parameter files have it. Raises VoltcamError for a file without any, OSError for one that is not there."""
    with path.open("rb") as file:
        text = file.read(MOST_BYTES).decode(errors="replace")
    found = {}
    for line in text.splitlines():
        name, colon, value = line.partition("#")[0].partition(":")
        name, value = name.strip(), value.strip()
        if colon and value.isdecimal() and name.endswith(("_coarse", "_fine")):
            found[name] = int(value)
    if not found:
        raise VoltcamError(f"{path} has no bias: give a file with lines such as ONBn_fine: 200")
    return found


def _given(word: str) -> tuple[str, int]:
    name, _, value = word.partition("=")
    if not value.isdecimal():
        raise VoltcamError(f"{word!r} sets no bias: give NAME=NUMBER, such as ONBn_fine=200")
    return name, int(value)
