"""Arguments that several commands of `voltcam` take."""

import math

from voltcam_client import camera

URL_HELP = f"where the camera is (default: {camera.DEFAULT_URL})"


def seconds(text: str) -> float:
    """An argument's type; argparse shows its name to the user."""
    number = float(text)
    if not 0 < number < math.inf:
        raise ValueError
    return number
