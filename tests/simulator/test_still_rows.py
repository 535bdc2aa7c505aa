"""Which rows stand still, and when; what they do then is in test_waiting_times."""

import numpy as np
import pytest

from voltcam_simulator.still_rows import LONGEST_US, StillRows


def rows_of(height: int = 4, width: int = 3) -> StillRows:
    return StillRows(width, height, 1, np.zeros(width * height, np.float32))


def image(*levels: float, dtype: type = np.uint8) -> np.ndarray:
    """One level for each row."""
    return np.repeat(np.array(levels, dtype)[:, None], 3, axis=1)


def steps(rows: StillRows) -> list[int]:
    return rows.of_band(slice(0, 4)).still_steps.tolist()


def test_a_row_counts_the_steps_in_which_no_pixel_changes() -> None:
    rows, still = rows_of(), image(1, 2, 3, 4)
    for _ in range(3):
        rows.look(still, still, 100)
    assert steps(rows) == [3, 3, 3, 3]
    moved = still.copy()
    moved[1, 2] += 1
    rows.look(still, moved, 100)
    assert steps(rows) == [4, 0, 4, 4]


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_changes_are_seen_in_the_bytes_of_either_type(dtype: type) -> None:
    rows = rows_of()
    rows.look(image(1, 2, 3, 4, dtype=dtype), image(1, 2, 3, 5, dtype=dtype), 100)
    assert steps(rows) == [1, 1, 1, 0]


def test_another_type_and_too_long_a_step_are_changes_of_all_rows() -> None:
    rows, still = rows_of(), image(1, 2, 3, 4)
    rows.look(still, still, LONGEST_US)
    assert steps(rows) == [1, 1, 1, 1]
    rows.look(still, still, LONGEST_US + 1)
    assert steps(rows) == [0, 0, 0, 0]
    rows.look(still, still, 100)
    rows.look(still, image(1, 2, 3, 4, dtype=np.float32), 100)
    assert steps(rows) == [0, 0, 0, 0]


def test_a_band_shares_its_rows_with_the_sensor() -> None:
    rows, still = rows_of(), image(1, 2, 3, 4)
    band = rows.of_band(slice(1, 3))
    rows.look(still, still, 100)
    assert band.still_steps.tolist() == [1, 1]
    assert (len(band.since_us), len(band.due_us), band.motion.shape) == (6, 6, (6, 2))
    band.due_us[0] = 5
    assert rows.of_band(slice(0, 4)).due_us.tolist() == [0, 0, 0, 5] + [0] * 8


def test_the_epoch_moves_on_and_takes_rows_ahead_with_it() -> None:
    rows = rows_of()
    all_rows = rows.of_band(slice(0, 4))
    all_rows.ahead[2] = True
    all_rows.drawn_us[:] = 100
    all_rows.since_us[:] = 200
    all_rows.due_us[:] = LONGEST_US + 5000
    rows.pass_by(LONGEST_US)
    assert (rows.steps, rows.now_us) == (1, LONGEST_US)
    rows.pass_by(1000)
    assert (rows.steps, rows.now_us) == (2, 0)
    assert all_rows.drawn_us[2] == 100 - LONGEST_US - 1000
    assert all_rows.since_us[6:9].tolist() == [200 - LONGEST_US - 1000] * 3
    assert all_rows.due_us[6:9].tolist() == [4000] * 3


def test_restored_rows_are_awake() -> None:
    rows, still = rows_of(), image(1, 2, 3, 4)
    rows.look(still, still, 100)
    rows.of_band(slice(0, 4)).ahead[:] = True
    rows.restore(7, 1234.0)
    assert (rows.steps, rows.now_us) == (7, 1234)
    assert steps(rows) == [0, 0, 0, 0]
    assert not rows.of_band(slice(0, 4)).ahead.any()


def test_memory_is_that_of_its_planes() -> None:
    assert rows_of(height=5, width=7).nbytes == 35 * 4 * (1 + 2)
