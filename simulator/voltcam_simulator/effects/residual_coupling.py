"""What an event does to its neighbours, that nobody has a name for, as a diagnosis finds it."""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..late_kicks import NEIGHBOURS
from .residual_kick import ResidualKick


class ResidualCoupling(ResidualKick):
    """A while after each event the voltages of its four neighbours are kicked, each by itself: up or down.
    What a kick sets off does not kick. With no delay, sizes of both signs alike and a chance of 1 it is
    `crosstalk`, which is the listed effect of this kind.

    The delay is log-normal. `late_kicks` says how a path is followed through a kick.
    """

    signature: ClassVar[str] = (
        "at some interval after a neighbour's event there are more or fewer events than any known effect"
        " gives"
    )

    targets: ClassVar[NDArray[np.int64]] = NEIGHBOURS
