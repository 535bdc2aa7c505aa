"""`voltcam dv run`: a program of dv-processing, as it is, with the emulator in place of its camera."""

import argparse
import runpy
import sys
from pathlib import Path

from voltcam_client.control import DEFAULT_URL
from voltcam_client.dv import drop_in
from voltcam_client.dv.cameras import DEFAULT_ADDRESS
from voltcam_client.errors import VoltcamError


def configure(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Run a program of dv-processing as it is: what opens or finds a camera gets the emulator."
    )
    parser.epilog = """\
examples:
  voltcam dv run tracker.py
  voltcam dv run --dv 127.0.0.1:7781 tracker.py --window 10
dv.io.camera.open, openSync, discover and DAVIS answer with the cameras of the daemon there, and so do
dv.io.CameraCapture and discoverDevices of dv-processing 1.7. All else is dv-processing's own."""
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    run = actions.add_parser("run", help="run a program", description=parser.description)
    run.add_argument(
        "--dv",
        metavar="HOST:PORT",
        action="append",
        help=f"a daemon's DV streams; may be given again (default: {DEFAULT_ADDRESS})",
    )
    run.add_argument(
        "--url", default=DEFAULT_URL, help=f"where the daemon is, for its biases (default: {DEFAULT_URL})"
    )
    run.add_argument("program", metavar="PROGRAM.py", type=Path, help="the program")
    run.add_argument("arguments", metavar="...", nargs=argparse.REMAINDER, help="its own arguments")
    run.set_defaults(run=_run)


def _run(args: argparse.Namespace) -> int:
    if not args.program.is_file():
        raise VoltcamError(f"{args.program} cannot be run: there is no such file")
    try:
        import dv_processing
    except ImportError as error:
        raise VoltcamError(f"voltcam dv needs dv-processing: pip install 'voltcam[dv]' ({error})") from None
    drop_in.install(dv_processing, args.dv or [DEFAULT_ADDRESS], args.url)
    sys.argv = [str(args.program), *args.arguments]
    sys.path.insert(0, str(args.program.resolve().parent))
    runpy.run_path(str(args.program), run_name="__main__")
    return 0
