"""Events that stay on the device."""

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

BRIGHT, DARK = np.full((3, 4), 250, np.uint8), np.full((3, 4), 10, np.uint8)


@pytest.mark.parametrize("preset", ["ideal", "typical"])  # the second has effects that act on events
def test_they_are_those_that_advance_gives(preset: str) -> None:
    here, there = (Simulator(4, 3, Parameters.of(preset), seed=2, device="cuda") for _ in range(2))
    total = 0
    for k, frame in enumerate((DARK, BRIGHT, DARK)):
        expected = here.advance(frame, 10_000 * k)
        np.testing.assert_array_equal(there.advance_on_device(frame, 10_000 * k).to_host(), expected)
        assert here.complete_us == there.complete_us
        total += expected.size
    assert total > 20


def test_a_processor_has_none() -> None:
    with pytest.raises(ValueError, match="call advance"):
        Simulator(4, 3).advance_on_device(DARK, 0)
