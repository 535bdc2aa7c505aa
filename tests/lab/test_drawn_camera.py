"""Cameras at random: in their ranges, repeatable, and refused where a range cannot be."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_lab.drawn_camera import CameraDistribution
from voltcam_simulator import Camera, Parameters


def drawn(cameras: CameraDistribution, count: int = 400) -> list[Parameters]:
    return [cameras.draw(np.random.default_rng(seed)).parameters for seed in range(count)]


def test_what_is_not_drawn_is_the_camera_s_own() -> None:
    camera = CameraDistribution.of("davis346").draw(np.random.default_rng(1))
    assert camera == Camera.load("davis346")


def test_each_kind_is_drawn_as_it_says() -> None:
    cameras = CameraDistribution.of(
        "davis346",
        {
            "comparator": {"theta_on": {"uniform": [0.8, 1.2]}, "theta_off": 1.5},
            "junction_leak": {"k4_per_us": {"log_uniform": ["1e-9", 1e-5]}},  # YAML 1.1 reads 1e-9 as text
            "temperature_c": {"choice": [20, 40]},
            "timestamp_quantum": {"quantum_us": {"uniform": [1, 4]}},
        },
    )
    every = drawn(cameras)
    thetas = np.array([each.comparator.theta_on for each in every])
    assert 0.8 <= thetas.min() < 0.82
    assert 1.18 < thetas.max() <= 1.2
    # Six standard errors of a mean of 400: by chance once in a billion seeds.
    assert abs(thetas.mean() - 1.0) < 6 * 0.4 / np.sqrt(12 * 400)
    decades = np.log10([each.junction_leak.k4_per_us for each in every])
    assert abs(decades.mean() + 7) < 6 * 4 / np.sqrt(12 * 400)
    assert {each.temperature_c for each in every} == {20, 40}
    assert {each.timestamp_quantum.quantum_us for each in every} == {1, 2, 3, 4}
    assert {each.comparator.theta_off for each in every} == {1.5}
    assert cameras.varied == (
        "comparator.theta_on", "junction_leak.k4_per_us", "temperature_c", "timestamp_quantum.quantum_us",
    )  # fmt: skip


def test_the_order_in_a_spec_draws_nothing_else() -> None:
    theta, leak = {"theta_on": {"uniform": [0.5, 2]}}, {"k4_per_us": {"log_uniform": [1e-9, 1e-5]}}
    one = CameraDistribution.of("davis346", {"comparator": theta, "junction_leak": leak})
    other = CameraDistribution.of("davis346", {"junction_leak": leak, "comparator": theta})
    assert drawn(one, 5) == drawn(other, 5)
    assert len({each.comparator.theta_on for each in drawn(one, 5)}) == 5


def test_a_calibrated_file_is_drawn_from_its_intervals(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(
        "intervals:\n  comparator.theta_on: [0.9, 1.1]\n  photon_noise.k3: [0, 0.001]\n"
        "  temperature_c: [30, 999]\n"
    )
    cameras = CameraDistribution.of(path, intervals=True)
    assert cameras.varied == ("comparator.theta_on", "photon_noise.k3", "temperature_c")
    assert all(0.9 <= each.comparator.theta_on <= 1.1 for each in drawn(cameras, 50))
    assert max(each.temperature_c for each in drawn(cameras, 50)) <= 125, "its limit"
    one = CameraDistribution.of(path, {"comparator": {"theta_on": "interval"}})
    assert one.varied == ("comparator.theta_on",)
    own = CameraDistribution.of(path, {"comparator": {"theta_on": 1.3}}, intervals=True)
    assert "comparator.theta_on" not in own.varied, "what the spec says comes first"


def test_one_of_several_cameras_is_drawn_with_its_own_intervals(tmp_path: Path) -> None:
    for name, low in (("first", 0.5), ("second", 2.0)):
        (tmp_path / f"{name}.yaml").write_text(
            f"name: {name}\nwidth: 20\nheight: 10\nintervals: {{comparator.theta_on: [{low}, {2 * low}]}}\n"
        )
    cameras = CameraDistribution.of([tmp_path / "first.yaml", tmp_path / "second.yaml"], intervals=True)
    made = [cameras.draw(np.random.default_rng(seed)) for seed in range(60)]
    assert {camera.name for camera in made} == {"first", "second"}
    assert all((camera.parameters.comparator.theta_on < 1.5) == (camera.name == "first") for camera in made)


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"comparater": {}}, r"parameters\.comparater: there is no such effect"),
        ({"comparator": {"theta": 1}}, r"comparator\.theta: there is no such parameter, only theta_on"),
        ({"comparator": 1}, r"parameters\.comparator: it has several parts"),
        ({"comparator": {"theta_on": {"normal": [1, 2]}}}, r"is no distribution: give a value"),
        ({"comparator": {"theta_on": {"uniform": 3}}}, "uniform takes a list, not 3"),
        ({"comparator": {"theta_on": {"uniform": [1, 2, 3]}}}, "uniform takes two numbers"),
        ({"comparator": {"theta_on": {"uniform": [2, 1]}}}, "takes a low and a high end, not 2 and 1"),
        ({"comparator": {"theta_on": {"uniform": [-1, 1]}}}, r"greater than or equal to 0\.001, not -1"),
        ({"comparator": {"theta_on": {"choice": [1, "much"]}}}, "valid number, .*, not 'much'"),
        ({"comparator": {"theta_on": "interval"}}, "davis346 has no interval of it"),
        ({"junction_leak": {"k4_per_us": {"log_uniform": [0, 1]}}}, "log_uniform begins above 0"),
        ({"temperature_c": {"uniform": [20, 500]}}, r"less than or equal to 125, not 500"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_line(parameters: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words) as refused:
        CameraDistribution.of("davis346", parameters)
    assert "\n" not in str(refused.value)


def test_a_camera_without_intervals_is_said() -> None:
    with pytest.raises(ValueError, match="davis346 has no intervals: `voltcam calibrate` writes"):
        CameraDistribution.of("davis346", intervals=True)
