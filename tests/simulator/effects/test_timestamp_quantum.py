"""The time stamp quantum by its signature: multiples of it, rounded down."""

import numpy as np
import pytest

from voltcam_simulator import Parameters, Simulator

from ..scenes import watch_still


@pytest.mark.parametrize(("quantum_us", "fps"), [(10, 240), (64, 1000), (5000, 1000)])
@pytest.mark.parametrize("t0_us", [0, -1_234_567])
def test_stamps_are_multiples_of_the_quantum(quantum_us: int, fps: float, t0_us: int) -> None:
    base = Parameters.of("typical")
    coarse = base.changed({"timestamp_quantum": {"quantum_us": quantum_us}})
    before, after = (watch_still(Simulator(30, 30, p, seed=1), 200, 2, fps, t0_us) for p in (base, coarse))
    assert len(before) > 1000
    assert (after["t"] % quantum_us == 0).all()
    assert (after["t"] == np.floor(before["t"] / quantum_us) * quantum_us).all()
    for name in ("x", "y", "p"):
        assert (after[name] == before[name]).all()
