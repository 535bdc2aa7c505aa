"""What a sensor has seen before a recording begins."""

import numpy as np
import pytest

from voltcam_lab.models.run_up import run_up
from voltcam_simulator import Parameters, Simulator


@pytest.mark.parametrize(("lead_in_us", "there_us", "wanted"), [
    (250, 0, [(2, -251), (2, -250), (1, -100)]),
    (249, 0, [(1, -101), (1, -100)]),
    (0, 0, [(0, -1)]),
    (250, 900, [(2, -900), (2, -250), (1, -100)]),
])  # fmt: skip
def test_a_camera_has_seen_backwards_what_comes(
    lead_in_us: int, there_us: int, wanted: list[tuple[int, int]]
) -> None:
    """Images 0 to 3, whose grey levels are their numbers."""
    images = np.broadcast_to(np.arange(4, dtype=np.float32)[:, None, None], (4, 2, 2))
    shown = run_up(images, [0, 100, 250, 300], lead_in_us, there_us)
    assert [(int(image[0, 0]), t_us) for image, t_us in shown] == wanted


def test_pixels_of_a_moving_scene_do_not_begin_as_those_of_a_still_one() -> None:
    """Light that has risen before it falls: the first event of a pixel tells where its voltage was."""
    t_us = np.arange(0, 1_000_001, 10_000)
    level = 60 * np.exp(0.9 * t_us * 1e-6)  # rises by 4 thresholds; mirrored, it falls before
    images = np.tile(level[:, None, None], (1, 12, 12)).astype(np.float32)
    parameters = Parameters.of("paper").changed({"contrast_response": {"k1": 5.0, "k2_dn": 0.5}})
    first_us = []
    for lead_in_us in (0, 500_000):
        simulator = Simulator(12, 12, parameters, seed=1)
        simulator.advance_along(run_up(images, t_us.tolist(), lead_in_us))
        events = simulator.advance_along(zip(images, t_us.tolist(), strict=True))
        events = events[(events["t"] > 0) & events["p"]]
        pixel = events["y"].astype(int) * 12 + events["x"]
        first_us.append(np.median(events["t"][np.unique(pixel, return_index=True)[1]]))
    assert first_us[1] > first_us[0] + 50_000  # it has to come back from where it fell to
