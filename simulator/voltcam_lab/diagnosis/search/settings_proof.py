"""Settings of what is tried, named and reported. Units and sources are as in `settings.py`."""

from dataclasses import dataclass


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
    tried_share: float = 0.5
    """Share of `least_gain` that a score must have for the first effects to be tried. Convention: a straight
    line may tell half of what a fit does."""
    light_gain: float = 5.0
    """Mean training loss by which twins gain less than a recording does: frames leave the recording's light
    open. It is spread as the square of a normal error. Statistics of any light have none of it. Here the
    light lies on a curve. Measured on 16 of the generator's development recordings without an effect: 4.4 in
    the mean of four of 200 frames/s, 3.5 in the median of all, of 25 to 200, and 7.9 in their mean."""
    guessed_light_gain: float = 12.0
    """The same where motion between frames was guessed. Measured: 11.9 on seven such recordings of 25 to 37
    frames/s, 8.2 on five of 39 to 83 later."""


@dataclass(frozen=True)
class Trials:
    """Which effects are fitted by simulation, and from where."""

    at_a_time: int = 3
    """Effects that are tried for their score before it is asked whether one explains the gap. Convention:
    time."""
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
    rounds: int = 0
    """Sets of derivatives that are taken in fits of an effect but the last. Convention: time; they begin with
    those of the model without it."""
    last_rounds: int = 3
    """Sets of derivatives in the last fit of the best effect. Convention."""


@dataclass(frozen=True)
class Naming:
    """When effects are named: they are likelier to be there than to stand in for something without a name,
    and stand-ins seldom have such odds (`evidence.py`)."""

    light: float = 0.1
    """Mean excess that light leaves where nothing is missing. Measured: 0.10 on 16 recordings without an
    effect, of 25 to 200 frames/s."""
    light_nats: float = 12.0
    """Nats by which all pixels tell recordings in which nothing is missing, in the mean of an exponential
    law. Measured: 5 % of 42 recordings of 25 to 200 frames/s, with the true parameters, have more than 32, as
    with a mean of 11. The law has a longer tail: the mean of the 35 with enough events is 4.9."""
    form: float = 0.02
    """Share of the excess before any effect was found that their forms leave besides. Measured: 0.02 to 0.04
    of 2.7 to 16 on three recordings with an effect."""
    wrong: float = 0.05
    """How often something without a name may be given one. Asked."""
    stand_in: tuple[float, float] = (0.42, 0.24)
    """Mean and sd of the shares that stand-ins leave. Measured: 0.42 and 0.22 on 15 development recordings of
    effects that have no name, were deleted, or got a wrong name; a sixteenth may be farther off."""
    unseen: float = 0.05
    """The power that the law of p-values comes to where much is missing still: the catalogue knows no such
    shape at times. Measured: of those 15, four have p-values above 0.01."""
    besides: float = 0.5
    """How likely it is that something else is missing besides. Convention: even odds."""


@dataclass(frozen=True)
class Proof:
    """What a trial must have to be an explanation at all, and which others do as well."""

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
    amount_log_step: float = 0.05
    """Width of the interval in which that one is in the end [log]. Convention."""
    systematic_log_sd: float = 0.16
    """sd of the log of a size for its form and the light, beside that of twins. Measured: of 23 sizes of the
    generator's development recordings 90 % intervals then hold 21, and 16 with 0.1."""
    fewest_strata: int = 5
    """Statistics that are listed at least, also where none is beyond chance. Convention."""
    most_strata: int = 50
    """Statistics that are listed at most. Convention."""
    false_discoveries: float = 0.1
    """False discovery rate of the listed statistics. Convention."""
