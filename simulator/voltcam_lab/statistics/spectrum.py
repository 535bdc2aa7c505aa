"""E: periods in the light: the largest Rayleigh amplitude around the frequencies of the mains, and elsewhere.

ON counts +1 and OFF -1: light that flickers gives them by turns. There are narrow bands around 50, 60, 100
and 120 Hz; a sum at just these frequencies would see less of a lamp a little beside them.
"""

from itertools import pairwise

import numpy as np
import scipy.fft

from voltcam_lab.statistics.group import MOTION, Group, Values, labels, sums, tally
from voltcam_lab.statistics.setting import PARTS, Setting
from voltcam_lab.statistics.stream import EventTable

SPECTRUM_BIN_US = 1000
SCAN_HZ = (20.0, 45.0, 55.0, 65.0, 95.0, 105.0, 115.0, 125.0, 200.0, 300.0, 480.0)
_NAMES = tuple(f"{low:g} to {high:g} Hz" for low, high in pairwise(SCAN_HZ))

_LABELS = labels("E", "largest amplitude of ON - OFF", "value", MOTION, ("band", _NAMES), floor=0.25)


def observe_spectrum(setting: Setting, stream: EventTable) -> Values:
    """Amplitudes are |sum of +-exp(2 pi i f t)| / sqrt(n): .9 on average where events come at random."""
    begin_us, end_us = setting.block_edges_us[[0, -1]]
    bins = int((end_us - begin_us) // SPECTRUM_BIN_US) + 1
    index = stream.moving * bins + (stream.t_us - begin_us) // SPECTRUM_BIN_US
    signed = sums(stream.part, index, 2 * stream.on - 1, 2 * bins).reshape(PARTS, 2, bins)
    events = tally(stream.part, stream.moving, 2)
    amplitude = scan(signed) / np.sqrt(np.maximum(events, 1))[..., None]
    return amplitude.reshape(PARTS, -1)


def scan(series: Values) -> Values:
    """(..., bands) largest |Fourier sum| of counts (..., bins) in each band of SCAN_HZ."""
    size = scipy.fft.next_fast_len(2 * series.shape[-1], real=True)  # a line falls between two frequencies
    amplitude = np.abs(np.asarray(scipy.fft.rfft(series, size)))
    edges = np.searchsorted(scipy.fft.rfftfreq(size, SPECTRUM_BIN_US * 1e-6), SCAN_HZ)
    largest: Values = np.maximum.reduceat(amplitude, edges, axis=-1)[..., :-1]
    return largest


SPECTRUM = Group("E", _LABELS, observe_spectrum)
