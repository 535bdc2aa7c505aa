"""Cameras by name and by file."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from pydantic import ValidationError

from voltcam_simulator import Camera, Parameters, camera_names


@pytest.mark.parametrize("name", ["paper", "typical"])
def test_the_published_set(name: str) -> None:
    """k1..k6 as in the table of the paper's supplement."""
    camera = Camera.load(name)
    p = camera.parameters
    k = (
        p.contrast_response.k1, p.contrast_response.k2_dn, p.photon_noise.k3, p.junction_leak.k4_per_us,
        p.parasitic_photocurrent.k5_per_dn_us, p.leak_noise.k6,
    )  # fmt: skip
    assert (camera.width, camera.height, *k) == (346, 260, 5.265, 20, 1e-4, 1e-7, 5e-9, 1e-5)
    assert p == Parameters.of(name)


def test_the_published_set_of_the_other_camera() -> None:
    camera = Camera.load("paper240c")
    p = camera.parameters
    k = (
        p.contrast_response.k1, p.contrast_response.k2_dn, p.photon_noise.k3, p.junction_leak.k4_per_us,
        p.parasitic_photocurrent.k5_per_dn_us, p.leak_noise.k6,
    )  # fmt: skip
    assert (camera.width, camera.height, *k) == (240, 180, 4.42411, 23, 2e-4, 1e-7, 5e-8, 1e-5)
    assert {effect.name for effect in p.effects() if effect.active} == {
        effect.name for effect in Parameters.of("paper").effects() if effect.active
    }


@pytest.mark.parametrize(("name", "size"), [("davis346", (346, 260)), ("davis240c", (240, 180))])
def test_the_cameras_that_were_measured(name: str, size: tuple[int, int]) -> None:
    """Light that grows 1.5 times on a bright pixel is an ON event or more, and its loss an OFF event."""
    camera = Camera.load(name)
    p = camera.parameters
    assert (camera.width, camera.height) == size
    steps = p.contrast_response.k1 * np.log(
        (150 + p.contrast_response.k2_dn) / (100 + p.contrast_response.k2_dn)
    )
    assert 0.5 < steps / p.comparator.theta_on < 3
    assert 0.5 < steps / p.comparator.theta_off < 3


@pytest.mark.parametrize("name", ["davis346", "davis240c"])
def test_nothing_of_a_recording_is_in_a_preset(name: str) -> None:
    """Frames of other sources have another period, other stamps, and are light."""
    p = Parameters.of(name)
    assert not p.aps_coupling.active
    assert not p.arbiter_scan.active
    assert not p.input_response.active
    assert p.latency.delay_us < 1000


@pytest.mark.parametrize("name", camera_names())
def test_a_camera_survives_its_file(name: str, tmp_path: Path) -> None:
    camera = Camera.load(name)
    path = tmp_path / "mine.yaml"
    path.write_text(camera.to_yaml())
    assert Camera.load(path) == camera


def test_what_a_file_leaves_out_has_its_default(tmp_path: Path) -> None:
    path = tmp_path / "small.yaml"
    path.write_text("width: 64\nheight: 48\ncomparator: {theta_on: 1.3}\n")
    camera = Camera.load(path)
    assert (camera.width, camera.height) == (64, 48)
    assert camera.parameters == Parameters().changed({"comparator": {"theta_on": 1.3}})


@pytest.mark.parametrize(
    ("content", "error", "message"),
    [
        ("width: 0\nheight: 4\n", ValidationError, "width"),
        ("comparator: {theta_on: -1}\n", ValidationError, "theta_on"),
        ("thresholds: 3\n", ValidationError, "thresholds"),
        ("width: 64\n", ValueError, "no height: give width and height, or neither"),
    ],
)
def test_a_broken_file_is_named(tmp_path: Path, content: str, error: type[Exception], message: str) -> None:
    path = tmp_path / "broken.yaml"
    path.write_text(content)
    with pytest.raises(error, match=message):
        Camera.load(path)


def test_the_paper_s_camera_has_nothing_beyond_the_paper() -> None:
    assert Parameters.of("paper") == Parameters()
    on = [effect.name for effect in Parameters.of("ideal").effects() if effect.active]
    assert on == ["contrast_response", "comparator"]


def test_named_files_hold_nothing_unknown() -> None:
    for name in camera_names():
        assert yaml.safe_load(Camera.load(name).to_yaml())["name"] == name
