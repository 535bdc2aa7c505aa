"""A camera that warms up."""

from dataclasses import replace

import pytest

from voltcam_lab.diagnosis.catalogue.entries import catalogue
from voltcam_lab.diagnosis.catalogue.temperature_drift import Warming
from voltcam_simulator import Parameters

from ..made_rig import made_clues

CLUES = made_clues()


@pytest.mark.parametrize("rate", [3.0, -3.0])
def test_a_warming_passes_the_temperature_of_the_camera_file_in_the_middle(rate: float) -> None:
    warming = next(one for one in catalogue(CLUES) if isinstance(one, Warming))
    after = warming.on(Parameters.of("paper"), (rate,))
    assert after.temperature_c + rate * CLUES.seconds / 2 == pytest.approx(25)


def test_a_warming_begins_and_ends_where_a_camera_may_be() -> None:
    warming = next(one for one in catalogue(CLUES) if isinstance(one, Warming))
    long = replace(warming, seconds=60.0)
    assert [long.on(Parameters.of("paper"), (rate,)).temperature_c for rate in (10, -10)] == [-40, 125]
