"""The limits of the machine, and the paper's law in plain numpy, on small arrays."""

from collections.abc import Callable

import numpy as np
import pytest

from voltcam_server.bench import limits
from voltcam_server.bench.limits import MachineLimits, numpy_paper_law


@pytest.fixture
def actions(monkeypatch: pytest.MonkeyPatch) -> list[Callable[[], object]]:
    """What would be timed; half a second is said of each."""
    kept: list[Callable[[], object]] = []

    def repeated(action: Callable[[], object]) -> list[float]:
        kept.append(action)
        return [0.5, 0.25, 1.0]

    monkeypatch.setattr(limits, "repeated", repeated)
    return kept


def test_the_limits_are_bytes_and_numbers_over_seconds(actions: list[Callable[[], object]]) -> None:
    limits = MachineLimits.measured()
    copy, sort = limits.figures
    assert (copy.median, copy.unit) == (64 * 2**20 / 0.5 / 1e9, "GB/s")
    assert (sort.median, sort.unit) == (0.5 / 100_000 * 1e9, "ns/event")
    assert (copy.least, copy.most) == (copy.median / 2, copy.median * 2)
    assert limits.seconds(copied_bytes=2**20, events=100) == pytest.approx(
        2**20 / (128 * 2**20) + 100 * 0.5 / 1e5
    )
    assert (np.diff(actions[1]().astype(np.int64)) >= 0).all()  # type: ignore[attr-defined]


def test_the_law_in_numpy_is_pixels_over_seconds(actions: list[Callable[[], object]]) -> None:
    frames = np.random.default_rng(1).integers(0, 256, (5, 6, 8), np.uint8)
    (figure,) = numpy_paper_law(frames)
    assert figure.median == pytest.approx(4 * 6 * 8 / 0.5 / 1e6)
    assert figure.unit == "Mpx/s"


def test_the_law_in_numpy_draws_one_time_for_each_pixel_and_frame(
    actions: list[Callable[[], object]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its inverse Gaussian has the mean distance/|mu| and the shape (distance/sigma)^2 of the paper."""
    drawn: list[tuple[np.ndarray, np.ndarray]] = []

    class Generator:
        def wald(self, mean: np.ndarray, shape: np.ndarray) -> np.ndarray:
            drawn.append((mean, shape))
            return np.full(mean.shape, 1e12)  # nobody fires

    monkeypatch.setattr(np.random, "default_rng", lambda _seed: Generator())
    frames = np.full((3, 2, 2), 128, np.uint8)
    numpy_paper_law(frames)
    actions[0]()
    mu, sigma = 1e-7 + 5e-9 * 128, 1e-4 * np.sqrt(128) / 148 + 1e-5
    assert len(drawn) == 2
    np.testing.assert_allclose(drawn[0][0], 1 / mu)
    np.testing.assert_allclose(drawn[0][1], 1 / sigma**2)
