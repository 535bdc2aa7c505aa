"""Dots: how far a model is from the best, beside the floor."""

import pytest
from tests.lab.pages.drawn import with_data

from voltcam_lab.distances import HEADLINES
from voltcam_lab.evaluation.figures.dots import dots


def test_dots_are_as_far_from_the_best_as_the_model_is() -> None:
    row = {"W1": 0.1, "TVs": 0.2, "pair": 0.3, "b4": 0.9, "AUC": 0.8}
    figure = dots({"exact": row}, {"pixels": dict.fromkeys(row, 0.6)})
    lines = [line for axes in figure.get_axes() for line in axes.lines if line.get_marker() == "o"]
    drawn = [float(line.get_xdata()[0]) for line in lines]
    assert dict(zip(HEADLINES, drawn, strict=True)) == pytest.approx(
        {"W1": 0.1, "TVs": 0.2, "pair": 0.3, "b4": 0.1, "AUC": 0.3}
    )


def test_what_is_not_known_has_no_dot_and_no_floor() -> None:
    row = {"W1": 0.1, "TVs": 0.2, "pair": 0.1, "b4": 0.9, "AUC": float("nan")}
    figure = dots({"exact": row}, {"pixels": {**row, "AUC": 0.5}})
    assert with_data(figure) == len(HEADLINES) - 1
