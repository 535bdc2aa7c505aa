"""The numbers that steer a search: meaning, unit, and where each is from.

Units. A *z* is a deviation of one statistic in standard deviations of simulated twins. A *gap* is the mean
Huber loss of z over the statistics; chance alone leaves about 0.25 to 0.5 of it. The *excess* is the gap over
what chance leaves. *Training loss* is the Huber loss summed over the statistics of the training parts. *Log*
is a natural logarithm of a parameter.

Sources. "Convention": chosen, nothing was measured for it. "Development": chosen so that generated recordings
(tests/generator) at development seeds, which no report uses, got the right verdicts.
"""

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
    descents: int = 3
    """Steps for each set of derivatives. Convention."""
    size_steps: tuple[float, ...] = (0.15, 0.5)
    """Steps of an effect's size that are tried, the base following [log]. Development: without them a fit
    stops in the curved valleys in which base parameters stand in for an effect."""
    least_gain: float = 0.005
    """Gap: a step that lowers it by less is the last. Convention."""
    joint_rounds: int = 2
    """Sets of derivatives where a model is fitted anew without one of its effects. Convention."""
    precise_longest_step: float = 0.5
    """Largest distance of the final size from that of the last fit [log]. Convention."""
    precise_rounds: int = 5
    """Rounds of reweighting for the final size. Convention: it converges in fewer."""


@dataclass(frozen=True)
class ScoreTest:
    """Which signatures of the catalogue are in the gap, and whether by more than chance."""

    alpha: float = 0.01
    """Chance of a name where nothing is missing, over the whole catalogue. Convention."""
    next_alpha: float = 1e-4
    """The same for each further effect. Development: an effect in the model has not quite the form of the
    one in the camera, and what that leaves is like another effect."""
    least_gain: float = 30.0
    """Training loss that an effect must explain. Development: the light between frames gains nearly that."""
    least_gain_share: float = 0.01
    """The same for a further effect, as a share of the training loss explained so far. Development."""
    light_gain: float = 6.0
    """Mean training loss by which twins gain less than a recording does: frames leave the recording's light
    open. It is spread as the square of a normal error. Development: recordings without an effect."""
    light_quantiles: int = 28
    """Quantiles of that distribution which are added to each twin's gain. Convention."""


@dataclass(frozen=True)
class Trials:
    """Which effects are fitted by simulation, and from where."""

    most: int = 3
    """Effects that are tried for their score. Convention: time."""
    least_score: float = 0.25
    """An effect of a smaller share of the best score is not tried. Convention."""
    most_from_file: int = 2
    """Effects that are tried besides, as nearest from the camera file. Convention: time."""
    far_gap: float = 2.0
    """Gap from which the score test alone says little. Convention: eight times what chance leaves."""
    large_gap: float = 1.0
    """Gap from which a fit begins at several places. Convention: four times what chance leaves."""
    amounts: tuple[float, ...] = (0.4, 1.0, 2.5)
    """Amounts of a signature from which a fit then begins, base parameters following. Convention."""
    file_amounts: tuple[float, ...] = (1, 2.5)
    """Amounts of each size tried, from which a fit begins on the camera file's base. Convention."""
    amount_limits: tuple[float, float] = (0.03, 3)
    """Limits of the amount that the score test gives a fit to begin with. Convention."""
    base_limit: float = 0.5
    """Limit of the change of base parameters that goes with it [log]. Convention."""
    scatter: float = 2.0
    """An effect whose runs scatter by this many times the sd without it brings a scatter of its own.
    Development: a few hot pixels differ more from run to run than all twins without any."""
    scattered_share: float = 0.02
    """Share of the statistics with such a scatter, from which a fit is repeated in its units. Convention."""
    nearly_best: float = 0.7
    """An effect that removes this share of what the best one does is fitted a second time. Convention."""
    at_chance: float = 0.1
    """Excess: an effect that leaves no more needs no second fit. Convention."""
    last_rounds: int = 3
    """Sets of derivatives in the last fit of the best effect. Convention."""


@dataclass(frozen=True)
class Proof:
    """What an effect must explain to be named, as shares of the excess that it was found at."""

    closed: float = 0.25
    """Excess that an explanation may leave. Development: what the light between frames leaves open."""
    left_behind: float = 0.04
    """Share of the excess explained so far that may be left besides. Development: effects have another
    form in the camera."""
    closing_share: float = 0.6
    """Share that the first effect must remove where it closes the gap. Development: a small gap is soon
    closed by half."""
    least_share: float = 0.3
    """The same for a further effect, and for one that removes `share` of it in the statistics it moves.
    Development."""
    share: float = 0.8
    """Share with which an effect is named though not all is explained. Development."""
    plain_excess: float = 1.0
    """Excess that is plain to see. Convention: four times what chance leaves. Development: an effect of
    another form leaves less."""
    plain_share: float = 0.9
    """Instead of `share` where more than `plain_excess` is left. Development: what has no name may look like
    an effect."""
    distinct_share: float = 0.75
    """Instead of `share` for the first effect where no other removes `others_share`. Development."""
    others_share: float = 0.25
    """See `distinct_share`. Development: what stands in for something without a name is seldom alone."""
    together_share: float = 0.9
    """Share that several effects must remove together, none of which is enough alone. Development."""
    last_share: float = 0.5
    """Share of the excess before it that the last of these must remove. Development."""
    moved: float = 2.0
    """z by which an effect changes a statistic that counts as moved by it. Convention."""
    held_out_share: float = 0.3
    """Share of the training gain that held-out data must confirm. Convention."""
    held_out_possible: float = 0.5
    """Least share of the training gain that held-out data could confirm: of a few hot pixels they may have
    less than the training parts. Development."""
    strongest: float = 20.0
    """Times the largest size that is looked for: a stronger effect is not named. Development: nearly all
    pixels dead would explain any camera file with too much noise."""
    part_share: float = 0.25
    """An effect that removes less is no part of an explanation. Development: to go on from less takes most
    of the time and ends in "unknown" all the same."""
    few_runs: float = 0.1
    """Gap by which a trial, seen in a few runs, may be too large. Development."""
    unnamed: float = 0.15
    """Excess above which what effects leave is held against drifts and noises without a name. Development."""
    tied: float = 15.0
    """Training loss: effects that differ by less are not told apart. Development."""
    tied_per_distance: float = 2.0
    """Training loss added to `tied` for each z of distance between what two effects do. Of two models at a
    distance d the true one has the lesser loss by d^2/2, give or take d: two standard deviations."""


@dataclass(frozen=True)
class OpenRoute:
    """Drifts and noises without a name that are tried on a gap no effect explains."""

    powers: tuple[float, ...] = (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0)
    """Powers of brightness. Convention."""
    steepness: float = 8.0
    """Growth over the image relative to the drift in its middle. Convention: nearly no drift there."""
    leaks: tuple[float, ...] = (0.25, 2.0)
    """Sizes of drifts, in leaks at 128 DN. Development: a small one slows the leak, a large one turns it
    round, and neither is the other's multiple."""
    noise_variance: float = 4.0
    """Size of noises, in variances of the noise at 128 DN. Convention."""


@dataclass(frozen=True)
class Reporting:
    """What is said of a search; no verdict depends on it."""

    mixed: float = 0.6
    """Correlation from which two base parameters are said to be mixed up. Convention."""
    fixed: float = 0.9
    """Share of the prior's variance that must go for a base parameter to be "fixed". Convention."""
    partly_fixed: float = 0.5
    """The same for "in part". Convention."""
    amounts: tuple[float, float] = (1e-3, 30.0)
    """Least and largest amount of a size at which the smallest detectable one is looked for. Convention."""
    systematic_log_sd: float = 0.16
    """sd of the log of a size for its form and the light, beside that of twins. Measured: of 23 sizes of the
    generator's development recordings 90 % intervals then hold 21, and 16 with 0.1."""
    most_strata: int = 50
    """Statistics that are listed at most. Convention."""
    false_discoveries: float = 0.1
    """False discovery rate of the listed statistics. Convention."""


@dataclass(frozen=True)
class SearchSettings:
    """All numbers that steer a search."""

    runs: Runs = field(default_factory=Runs)
    prior: Priors = field(default_factory=Priors)
    derivatives: Derivatives = field(default_factory=Derivatives)
    model_error: ModelError = field(default_factory=ModelError)
    fit: SimulationFit = field(default_factory=SimulationFit)
    score_test: ScoreTest = field(default_factory=ScoreTest)
    trials: Trials = field(default_factory=Trials)
    proof: Proof = field(default_factory=Proof)
    open_route: OpenRoute = field(default_factory=OpenRoute)
    reporting: Reporting = field(default_factory=Reporting)

    most_effects: int = 4
    """Effects from which no more are looked for. Convention: time."""
    longest_chain: int = 3
    """Effects that are added one after the other to explain a gap together. Convention: time."""
    unexplained: float = 0.25
    """Excess from which the verdict is "unknown" where no effect is named. Development: frames leave that
    much open without anything missing."""
    negligible: float = 0.05
    """Share of the strength at which an effect was added: one fitted to less in the end is not named.
    Convention."""
    taken_out_below: float = 0.8
    """Effects of the camera file are taken out where the gap without them is below this share of that with
    them. Convention."""


DEFAULTS = SearchSettings()
