"""Named groups of arrays and scalars that several kernels are given: Numba takes a NamedTuple as it is.

Numba compiles a kernel for the types that it meets, so the fields say in words what they hold. Voltages are
in nominal thresholds, n is the number of a band's pixels, planes are float32. A kernel takes the arrays that
its loops read out of a group first: the loops are then vectorised.

From kernel to kernel a group costs nothing. From Python each array in one costs 0.2 us a call, which a small
sensor feels: a kernel that Python calls takes the fields in their order, `cross(*pixels, *motion, ...)`.
"""

from typing import Any, NamedTuple


class Pixels(NamedTuple):
    """Where the pixels of a band stand; planes (n,)."""

    voltage: Any
    """As last drawn, and the drift since."""
    pending: Any
    """Variance gathered since the voltage was last drawn."""
    held: Any
    """Dead time left [us]."""
    above: Any
    """The ON threshold."""
    below: Any
    """The OFF threshold, as a distance from 0."""


class Place(NamedTuple):
    """Which pixels of the sensor a plane has, row after row; int. A plane of several steps begins with the
    first row again behind the last."""

    first_row: Any
    first_column: Any
    rows: Any
    columns: Any
    """All of a row for a band; 1 for a single pixel."""


class Motion(NamedTuple):
    """What one step does to the voltages of a band; planes (n,)."""

    drift: Any
    """Voltage gained over the step."""
    noise: Any
    """sigma [1/sqrt(us)]."""


class Bend(NamedTuple):
    """How the mean path of each pixel leaves the straight line between its ends, see `bends`; planes (n,).

    Both are None where nothing bends: the kernels are then compiled without.
    """

    bow: Any
    """Its largest distance from that line, above it or (less than 0) below."""
    rate: Any
    """Time constants in the step, by which what bends it dies away."""


class Step(NamedTuple):
    """One step of a band in time, and how its pixels are numbered; scalars."""

    key: Any
    """`interval_key` of its random numbers, uint64."""
    span_us: Any
    """Its length, float."""
    offset_us: Any
    """When it starts in its interval, float."""
    first_pixel: Any
    """Number of the band's first pixel in the sensor, int."""
    width: Any
    """Pixels in a row of the sensor, int."""


class Reset(NamedTuple):
    """What follows an event in its pixel; scalars."""

    dead_us: Any
    """Dead time."""
    sigma: Any
    """Spread of the voltage after the reset."""


class Kicks(NamedTuple):
    """Sudden changes of voltage in a step, which its drift includes; none: 0 kicks."""

    times_us: Any
    """(kicks, rows) float64 from the start of the step, each row in order."""
    sizes: Any
    """(kicks, rows) float64."""
    slack: Any
    """(n,) float32: how far the mean path, straight between kicks, may go beyond its ends; 0: no kick."""


class AheadRows(NamedTuple):
    """Rows of a band, of which some are drawn ahead, see `waiting_times`; times count from an epoch."""

    still_steps: Any
    """(rows,) int32: for how many steps the light has stood still."""
    ahead: Any
    """(rows,) bool: which are drawn ahead."""
    drawn_us: Any
    """(rows,) float32: when they were drawn."""
    since_us: Any
    """(n,) float32: from when a pixel waits, since its last event if that was after drawn_us."""
    due_us: Any
    """(n,) float32: when its next event is due; inf: never."""
    motion: Any
    """(n, 2) float32: mu [1/us] and sigma [1/sqrt(us)], side by side, since few are looked at."""
