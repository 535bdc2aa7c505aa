"""The live part of `voltcam bench`: a daemon of its own, looked at for a second."""

import numpy as np
import pytest

from voltcam_client.errors import VoltcamError
from voltcam_server.bench import live
from voltcam_server.bench.live import watched


def test_a_daemon_is_looked_at_from_outside() -> None:
    seen = watched(48, 36, (), 1.0)
    assert seen.simulated + seen.lost == pytest.approx(60, abs=45)
    assert set(seen.stages) == {"waiting", "simulating", "leaving"}
    assert min(seen.stages.values()) >= 0
    assert seen.ages == sorted(seen.ages)
    assert 0 < np.median(seen.ages) < 5000
    assert min(seen.ways) >= 0


def test_one_that_does_not_begin_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "PROGRAM", "")
    with pytest.raises(VoltcamError, match="does not run"):
        watched(48, 36, (), 0.1)
