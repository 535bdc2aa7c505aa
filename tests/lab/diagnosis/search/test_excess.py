"""Effects of the camera file that the recording does not show."""

from pathlib import Path

import pytest

from voltcam_lab.diagnosis.search.excess import own_effects, without_excess
from voltcam_lab.diagnosis.search.state import search_of
from voltcam_lab.diagnosis.session import session_of
from voltcam_lab.health import inspect
from voltcam_lab.recordings import Footage
from voltcam_simulator import Camera

from ..conftest import FEW_ENTRIES, FEW_RUNS

PAPER = Camera.load("paper")


@pytest.mark.parametrize(
    ("effects", "out"),
    [
        ({}, False),
        ({"refractory_period": {"period_us": 6000}}, False),
        ({"hot_pixels": {"fraction": 0.05, "rate_hz": 20}}, True),
        ({"refractory_period": {"period_us": 100_000}, "hot_pixels": {"fraction": 0.01}}, True),
    ],
    ids=["none", "one that is there", "noise that is not", "what is not like what is there"],
)
def test_effects_that_the_recording_does_not_show_are_taken_out(
    tiny: Footage, tmp_path: Path, effects: dict[str, dict[str, float]], out: bool
) -> None:
    """The recording has a refractory period of 6 ms, and no other effect."""
    camera = PAPER.model_copy(update={"parameters": PAPER.parameters.changed(effects)})
    session, said = session_of(inspect(tiny), camera, tmp_path, entries=FEW_ENTRIES), list[str]()
    assert set(own_effects(session)) == set(effects)
    bare = without_excess(session, search_of(session, FEW_RUNS, said.append))
    assert (bare is not None) == out
    assert len(said) == 2 * bool(effects)
    if bare is not None:
        assert bare.parameters == PAPER.parameters
        assert "taken out" in said[-1]
