"""`voltcam bench cuda` in numba's simulator of a GPU: what is measured, not how fast."""

from argparse import ArgumentParser

import pytest

from voltcam_server.bench import cuda
from voltcam_server.bench.cli import configure, run
from voltcam_server.bench.cuda import cuda_steps
from voltcam_server.problems import UsageError
from voltcam_simulator import NoDeviceError
from voltcam_simulator.cuda import arrays


def test_each_model_is_measured_with_frames_on_either_side(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "SIZES", {"12x9": (12, 9, 3)})
    monkeypatch.setattr(cuda, "REPEATS", 1)
    figures = [figure for step in cuda_steps() for figure in step()]
    assert [figure.name for figure in figures] == [
        f"12x9 {model}, frames on the {side}"
        for model in ("base model", "pixels of typical") for side in ("host", "device")
    ]  # fmt: skip
    for figure in figures:
        assert figure.unit == "Mpx/s"
        assert figure.median > 0
    on_host, on_device = (float(figure.remark.split()[0]) for figure in figures[:2])
    assert on_host == pytest.approx(on_device, abs=0.3)  # some twenty events, each time other numbers
    assert on_host > 0.05


def test_no_stage_behind_the_pixels_is_left_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "SIZES", {"12x9": (12, 9, 3)})
    parameters = [step.args[1] for step in cuda_steps()]  # type: ignore[attr-defined]
    on = {effect.name for one in parameters for effect in one.effects() if effect.active}
    assert not on & {"hot_pixels", "noise_pairs", "latency", "readout"}
    assert "photoreceptor_bandwidth" in on


def test_without_a_gpu_one_line_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing() -> None:
        raise NoDeviceError("device cuda finds no GPU")

    monkeypatch.setattr(arrays, "require", missing)
    parser = ArgumentParser()
    configure(parser)
    with pytest.raises(UsageError, match="device cuda finds no GPU"):
        run(parser.parse_args(["cuda"]))
