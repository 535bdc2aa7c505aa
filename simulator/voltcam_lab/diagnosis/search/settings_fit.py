"""Settings of fits: runs, what is likely beforehand, derivatives, steps. Sources are as in `settings.py`."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Runs:
    """Seeds of simulated runs. Four seeds in a row see the four versions of the light between frames."""

    twins: range = range(1000, 1028)
    """Twins of a step: mean, spread, and null of the score test. Convention: 28, cost against noise."""
    rough_twins: range = range(500, 508)
    """Twins where a rough spread is enough. Convention."""
    signatures: range = range(2)
    """Runs of an effect's signature, with noise common to the run without it. Convention."""
    fitting: range = range(4)
    """Runs of a fit: one for each version of the light."""
    slopes: range = range(2)
    """Runs of a derivative. Convention."""
    precise_slopes: range = range(8)
    """Runs of a derivative for the final size and its interval. Convention."""
    figures: int = 4
    """How many of the twins are drawn in figures of events: one for each version of the light."""


@dataclass(frozen=True)
class Priors:
    """What is taken for likely before a recording is looked at."""

    base_log_sd: float = 0.5
    """sd of the log of a base parameter (k1 to k6) about the camera file's. Convention: wider than the 30 %
    by which cameras of a make are taken to differ."""
    size_log_sd: float = 1.5
    """sd of the log of an effect's size about the size at which its fit begins. Convention."""
    amount_sd: float = 1.0
    """sd of an effect's amount in the score test, in sizes tried. Convention."""
    smallest_base: Mapping[str, float] = field(
        default_factory=lambda: {"k3": 1e-6, "k4_per_us": 5e-10, "k5_per_dn_us": 1e-12, "k6": 5e-7}
    )
    """Base parameters (each in its own unit) at which a fit begins where the camera file has less, or
    nothing: of nothing, no multiple is anything. Convention: too little to show in a recording of seconds."""
    other_camera_log: float = 0.8
    """Log by which a sharp base parameter is off where the file seems to be another camera's. Convention:
    twice the log of what cameras of a make are taken to differ by."""


@dataclass(frozen=True)
class Derivatives:
    """Steps of the log of a parameter for derivatives by simulation, half of it to each side."""

    step: float = 0.15
    """Step of the `sharp` base parameters [log]. Development: what they do bends within it."""
    wide_step: float = 0.5
    """Step of all others [log]. Development: what they do is lost in the runs' noise at a smaller one."""
    sharp: tuple[str, ...] = ("k1", "k2_dn", "k5_per_dn_us")
    """Base parameters that show sharply in a recording. Development."""


@dataclass(frozen=True)
class ModelError:
    """What a model is off by even where nothing is missing, added to the spread of its twins."""

    statistic_share: float = 0.003
    """sd, as a share of each statistic. Convention: the simulator is no better than that."""
    base_share: float = 0.01
    """sd, as a share of each base parameter. Development: intervals at rest fix leaks to a thousandth, and
    would outweigh all other statistics."""
    light_delay_us: float = 100.0
    """sd of a delay of all events that light between frames stands for [us]. What rounding leaves in it makes
    simulated events early, as noise does. Development: recordings without an effect ask for up to 260 us, to
    either side."""
    effect_share: float = 0.1
    """sd, as a share of what the effects in the model do, where more effects are looked for. Development: a
    real effect has not quite the form of the modelled one."""


@dataclass(frozen=True)
class SimulationFit:
    """A fit by simulation (Gauss and Newton's method)."""

    longest_step: float = 0.8
    """Largest step of a parameter [log]. Convention."""
    step_lengths: tuple[float, ...] = (1.0, 0.4, 0.1)
    """Shares of the step that are tried until one lowers the gap. Convention."""
    shortest_secant: float = 0.05
    """Length of a move [log] from which slopes are mended by what it did. Convention: less is lost in the
    runs' noise."""
    descents: int = 3
    """Steps for each set of derivatives. Convention."""
    size_steps: tuple[float, ...] = (0.15, 0.5)
    """Steps of an effect's size that are tried, the base following [log]. Development: without them a fit
    stops in the curved valleys in which base parameters stand in for an effect."""
    least_gain: float = 0.005
    """Gap: a step that lowers it by less is the last. Convention."""
    least_round_gain: float = 0.01
    """Gap: a set of derivatives whose steps lower it by less is the last. Convention: two such steps."""
    rough_rounds: int = 1
    """Sets of derivatives in the first fit of base parameters. Convention: the sd is not right yet."""
    base_rounds: int = 3
    """Sets of derivatives at most in the fits of base parameters that follow. Convention."""
    joint_rounds: int = 2
    """Sets of derivatives where a model is fitted anew without one of its effects. Convention."""
    reweightings: int = 8
    """Rounds of reweighting in a robust linear fit. Convention."""
    precise_longest_step: float = 0.5
    """Largest distance of the final size from that of the last fit [log]. Convention."""
    precise_rounds: int = 5
    """Rounds of reweighting for the final size. Convention: it converges in fewer."""
