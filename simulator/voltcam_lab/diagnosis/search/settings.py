"""The numbers that steer a search: meaning, unit, and where each is from.

Units. A *z* is a deviation of one statistic in standard deviations of simulated twins. A *gap* is the mean
Huber loss of z over the statistics; chance alone leaves about 0.25 to 0.5 of it. The *excess* is the gap over
what chance leaves. *Training loss* is the Huber loss summed over the statistics of the training parts. *Log*
is a natural logarithm of a parameter.

Sources. "Convention": chosen, nothing was measured for it. "Development": chosen so that generated recordings
(tests/generator) at development seeds, which no report uses, got the right verdicts.

Not here: sizes at which an effect is looked for and how it is measured, which are on its catalogue entry, and
numbers that no verdict depends on (processes, memory, lines on a terminal).
"""

import math
from dataclasses import dataclass, field

from ..rig.settings import RecordingSettings, RigSettings
from .settings_fit import Derivatives, ModelError, Priors, Runs, SimulationFit
from .settings_proof import Naming, OpenRoute, Proof, Reporting, ScoreTest, Trials


@dataclass(frozen=True)
class SearchSettings:
    """All numbers that steer a search."""

    recording: RecordingSettings = field(default_factory=RecordingSettings)
    rig: RigSettings = field(default_factory=RigSettings)
    runs: Runs = field(default_factory=Runs)
    prior: Priors = field(default_factory=Priors)
    derivatives: Derivatives = field(default_factory=Derivatives)
    model_error: ModelError = field(default_factory=ModelError)
    fit: SimulationFit = field(default_factory=SimulationFit)
    score_test: ScoreTest = field(default_factory=ScoreTest)
    trials: Trials = field(default_factory=Trials)
    proof: Proof = field(default_factory=Proof)
    naming: Naming = field(default_factory=Naming)
    open_route: OpenRoute = field(default_factory=OpenRoute)
    reporting: Reporting = field(default_factory=Reporting)

    huber_z: float = 5.0
    """z from which a deviation counts less than its square. It defines the gap: all gaps and training losses
    here are in its units. Convention: single statistics cannot dominate, and chance alone is all below."""
    most_effects: int = 4
    """Effects from which no more are looked for. Convention: time."""
    longest_chain: int = 3
    """Effects that are added one after the other to explain a gap together. Convention: time."""
    alarm: float = 0.05
    """How often light may leave as much where nothing is missing: if less often, the verdict is "unknown"
    where no effect is named (`left.py`). Asked."""
    negligible: float = 0.05
    """Share of the strength at which an effect was added: one fitted to less in the end is not named.
    Convention."""
    taken_out_below: float = 0.8
    """Effects of the camera file are taken out where the gap without them is below this share of that with
    them. Convention."""

    @property
    def most_by_light(self) -> float:
        """The excess that light alone leaves no more often than `alarm`."""
        return -self.naming.light * math.log(self.alarm)


DEFAULTS = SearchSettings()
