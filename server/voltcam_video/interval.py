"""What the ways to fill the interval between two frames have in common."""

from collections.abc import Iterator

from voltcam_video.frame import Frame

DARK_DN = 20.0  # goes before a logarithm: a DAVIS346's k2, the level below which its pixels see little


def follows(former: Frame, frame: Frame) -> bool:
    """Whether the scene went on from one frame to the other, so that there is something between them."""
    return not frame.cut and frame.t_us > former.t_us and frame.image.shape == former.image.shape


def instants(start_us: int, end_us: int, steps: int) -> Iterator[tuple[int, float]]:
    """The whole microseconds that divide the time into `steps`, each with the share 0..1 that has gone by.

    A step takes at least one microsecond, so there may be fewer.
    """
    span_us = end_us - start_us
    steps = min(steps, span_us)
    for step in range(1, steps):
        gone_us = (2 * span_us * step + steps) // (2 * steps)
        yield start_us + gone_us, gone_us / span_us
