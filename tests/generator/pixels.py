"""What a scene and its pixels are made of, as the kernels take it: named arrays and numbers."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]


PLAIN = np.ones((1, 1, 1), np.float32)  # of a disc without a pattern


class Canvas(NamedTuple):
    """What a scene is made of, apart from its motion."""

    texture: Singles  # (side, side), periodic, side a power of two; radiance relative to the shading
    shading: Singles  # (height, width) DN
    card: Singles  # (height, width) DN, negative where no card hangs
    disc_dn: Floats  # (discs,)
    disc_radius: Floats  # (discs,) pixels
    disc_print: Singles = PLAIN  # (1 or discs, side, side), as texture; moves with the disc, times its DN


class Tables(NamedTuple):
    """Over radiance, (kernel.TABLE,) each, kernel.PER_DN entries per DN."""

    leak_per_us: Floats  # all but the junction's
    sigma: Floats  # 1/sqrt(us)
    refractory_us: Floats
    cutoff_per_us: Floats  # 2 pi f of the photoreceptor


class Maps(NamedTuple):
    """(height, width) each."""

    theta_on: Floats
    theta_off: Floats
    junction_per_us: Floats
    drift_per_us: Floats


class State(NamedTuple):
    """(height, width) each, where the pixels are now."""

    v: Floats
    light: Floats
    log: Floats  # ln(L + k2)...
    slow: Floats  # ...behind the first pole...
    slower: Floats  # ...and the second
    dead_us: Floats  # until when the pixel is held
    rebound: Floats
    tired: Floats
    hum: Floats
    humming: Floats
    moved: Floats  # by everything but white noise and kicks, in this step


class Numbers(NamedTuple):
    """What is the same for all pixels. Times in microseconds, voltages in units of the nominal threshold."""

    k1: float
    k2: float
    follower_per_us: float = 0.0  # second pole, after that of the table; 0: neither
    reset_sigma: float = 0.0
    slew_per_us: float = np.inf  # the rate of d ln(L+k2)/dt that passes by half
    rebound: float = 0.0  # voltage that returns after an event, against it...
    rebound_us: float = 1.0  # ...with this time constant
    tiring: float = 0.0  # thresholds rise by this part after an event...
    tiring_us: float = 1.0  # ...and recover with this time constant
    crosstalk: float = 0.0  # given to the four neighbours, in the event's direction
    hum: float = 0.0  # s.d. of coloured noise at 50 DN
    hum_us: float = 1.0  # its time constant, twice
    kick: float = 0.0  # voltage is raised by it from a frame's exposure start to its row's readout...
    pulse_us: float = 0.0  # ...and lowered by it for so long after that
    row_us: float = 0.0  # readout time of a row
