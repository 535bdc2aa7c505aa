"""The biases of a running camera: what was set, and what sliders have changed since."""

import pytest

from voltcam_server.bias_panel import BiasPanel
from voltcam_simulator import Parameters
from voltcam_simulator.biases import Biases, BiasSet

CAMERA = Parameters.of("typical")


class Turned:
    """A camera, by its panel and its sliders."""

    def __init__(self) -> None:
        self.parameters, self._panel = CAMERA, BiasPanel(CAMERA)

    def set(self, **changes: int) -> None:
        biases, change = self._panel.wanted(self.parameters, changes)
        self.parameters = self.parameters.changed(change)
        self._panel.set(biases)

    @property
    def biases(self) -> BiasSet:
        return self._panel.now(self.parameters)


def test_a_camera_begins_with_the_usual_biases() -> None:
    assert Turned().biases == Biases()


def test_biases_are_read_as_they_were_set_one_after_the_other() -> None:
    camera = Turned()
    camera.set(DiffBn_fine=60)
    camera.set(ONBn_fine=90, ONBn_coarse=6)
    assert camera.biases == Biases(DiffBn_fine=60, ONBn_fine=90)
    assert camera.parameters.comparator.theta_on < 1
    assert camera.parameters.comparator.theta_off > 1


def test_a_bias_leaves_what_does_not_depend_on_it_as_the_slider_has_set_it() -> None:
    camera = Turned()
    camera.parameters = camera.parameters.changed({"refractory_period": {"period_us": 777}})
    camera.set(PrBp_fine=29)
    assert camera.parameters.refractory_period.period_us == 777
    assert camera.parameters.photoreceptor_bandwidth.cutoff_hz == pytest.approx(150)
    assert camera.biases.of("RefrBp").current == pytest.approx(
        Biases().of("RefrBp").current * 1000 / 777, rel=0.02
    )
