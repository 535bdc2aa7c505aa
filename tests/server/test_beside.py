"""APS frames, IMU samples and triggers beside a camera's events, in closed form."""

import numpy as np
import pytest

from voltcam_client.samples import TRIGGER_KINDS
from voltcam_server.beside import Beside, BesideEvents, DavisSettings
from voltcam_simulator import Parameters

from .rig import tiny

APS = {"frame_period_us": 10_000, "exposure_us": 500, "row_us": 100, "offset_us": 1000}
PARAMETERS = Parameters().changed({"aps_coupling": APS, "temperature_c": 40})
EXPOSED_US = 1600  # 16 rows
IMAGE = np.full((16, 24), 90, np.uint8)


def watch(settings: DavisSettings, times_us: list[int], jumps: tuple[int, ...] = (0,)) -> list[Beside]:
    beside = BesideEvents(tiny(), 1, settings)
    return [beside.until(IMAGE, t_us, PARAMETERS, jumped=i in jumps) for i, t_us in enumerate(times_us)]


def triggers_of(pieces: list[Beside], kind: str) -> list[int]:
    triggers = np.concatenate([piece.triggers for piece in pieces])
    return triggers["t"][triggers["kind"] == TRIGGER_KINDS[kind]].tolist()


def test_without_being_asked_there_is_nothing() -> None:
    for piece in watch(DavisSettings(), [0, 20_000, 40_000]):
        assert (len(piece.frames), piece.imu.size, piece.triggers.size) == (0, 0, 0)


def test_frames_are_exposed_when_aps_coupling_says() -> None:
    pieces = watch(DavisSettings(frames="aps"), [0, 20_000, 40_000])
    exposures = [frame.exposure_us for piece in pieces for frame in piece.frames]
    begins = [1000 + EXPOSED_US + 10_000 * i for i in range(4)]
    assert exposures == [(begin, begin + 500) for begin in begins]


def test_frames_are_of_light() -> None:
    """Grey level 90 of a video is 255 (90 / 255)^2.2 = 25.8 of light."""
    coded = PARAMETERS.changed({"input_response": {"gamma_exponent": 2.2}})
    beside = BesideEvents(tiny(), 1, DavisSettings(frames="aps"))
    pieces = [beside.until(IMAGE, t_us, coded, jumped=t_us == 0) for t_us in (0, 20_000)]
    assert {int(level) for level in np.unique(pieces[1].frames[0].image)} == {26}


def test_a_frame_that_a_jump_has_cut_is_lost() -> None:
    pieces = watch(DavisSettings(frames="aps"), [0, 2800, 2900, 9000], jumps=(0, 2))
    assert not any(piece.frames for piece in pieces)


def test_the_imu_has_its_rate_and_the_temperature() -> None:
    pieces = watch(DavisSettings(imu_hz=1000), [0, 20_000, 40_000], jumps=(0, 1))
    samples = np.concatenate([piece.imu for piece in pieces])
    assert samples["t"].tolist() == list(range(1000, 40_001, 1000))
    np.testing.assert_allclose(samples["temperature_c"], 40, atol=0.002)
    assert np.abs(samples["accel_g"].mean(0) - (0, -1, 0)).max() < 0.01


@pytest.mark.parametrize("times_us", [[0, 100_000], [0, 1, 9999, 10_000, 55_555, 100_000]])
def test_a_square_wave_has_two_edges_a_period(times_us: list[int]) -> None:
    pieces = watch(DavisSettings(triggers_hz=50), times_us)
    assert triggers_of(pieces, "rising edge") == [20_000, 40_000, 60_000, 80_000, 100_000]
    assert triggers_of(pieces, "falling edge") == [10_000, 30_000, 50_000, 70_000, 90_000]
    for piece in pieces:
        assert (np.diff(piece.triggers["t"]) >= 0).all()


def test_aps_frames_have_triggers_at_their_times() -> None:
    pieces = watch(DavisSettings(frames="aps", triggers_hz=1), list(range(0, 100_001, 5000)))
    frames = [frame for piece in pieces for frame in piece.frames]
    assert len(frames) == 10
    assert triggers_of(pieces, "exposure begins") == [frame.exposure_us[0] for frame in frames]
    assert triggers_of(pieces, "exposure ends") == [frame.exposure_us[1] for frame in frames]
    assert triggers_of(pieces, "frame begins") == [frame.frame_us[0] for frame in frames]
    assert triggers_of(pieces, "frame ends") == [frame.frame_us[1] for frame in frames]


def test_it_is_cut_at_a_time() -> None:
    settings = DavisSettings(frames="aps", imu_hz=1000, triggers_hz=100)
    whole = watch(settings, [0, 40_000])[1]
    before, rest = whole.cut(13_100)  # where the exposure of the second frame ends
    assert before.imu["t"].max() == 13_000
    assert rest.imu["t"].min() == 14_000
    assert (len(before.frames), len(rest.frames)) == (1, 3)
    assert before.triggers["t"].max() < 13_100 <= rest.triggers["t"].min()
    assert before.triggers.size + rest.triggers.size == whole.triggers.size
