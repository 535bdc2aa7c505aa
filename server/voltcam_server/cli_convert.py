"""`voltcam convert`: its arguments, and one line about what was written."""

import argparse
from pathlib import Path

from voltcam_client.cli_arguments import seconds
from voltcam_client.formats import SUFFIXES

from .cli_arguments import add_camera, add_picture, given_by
from .settings import load


def configure(parser: argparse.ArgumentParser) -> None:
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
    add_camera(parser)
    add_picture(parser)
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
    parser.set_defaults(run=_run)


def _run(args: argparse.Namespace) -> int:
    from .convert import Conversion
    from .convert import convert as run

    settings = load(given_by(args), environment={})
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
