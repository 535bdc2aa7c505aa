"""The page of a set: whole by itself, with what there is to see."""

import re
from pathlib import Path

import pytest
from tests.server.dataset.rig import clip, clips, made, spec

from voltcam_server.dataset.manifest import read_manifest
from voltcam_server.dataset.pictures import picture_of
from voltcam_server.dataset.show import show_set
from voltcam_server.problems import UsageError

DRAWN = {
    "comparator": {"theta_on": {"uniform": [0.2, 0.4]}},
    "junction_leak": {"k4_per_us": {"log_uniform": [1e-9, 1e-5]}},
    "temperature_c": {"choice": [20, 40]},
    "contrast_response": {"response": {"choice": ["logarithmic", "linearised"]}},
    "refractory_period": {"period_us": {"uniform": [0, 10]}},
}


def test_a_page_has_pictures_rates_parameters_and_what_to_look_at(tmp_path: Path) -> None:
    inputs = clips(tmp_path / "in", 4)
    clip(inputs / "<b>.npz", count=1)
    made(spec(tmp_path, f"{inputs}/*", variants=2, parameters=DRAWN), tmp_path / "set")
    page = show_set(tmp_path / "set", tmp_path / "page.html").read_text()
    for words in (
        "Data set set", "8, of 4 inputs", "tiny 24x16: 8", "Samples", "Event rates", "Drawn parameters",
        "clip0.npz, variant 1", "&lt;b&gt;.npz", "events need two, give a longer one (2 variants)",
    ):  # fmt: skip
        assert words in page, words
    assert page.count("data:image/png") == 8
    assert page.count("data:image/svg") == 1 + 2, "rates, and five parameters in two figures"
    assert not re.findall(r"(?:src|href)=\"(?!data:)", page), "nothing is loaded"


def test_one_item_without_frames_and_without_drawn_parameters_is_a_page(tmp_path: Path) -> None:
    clips(tmp_path / "in", 1)
    made(spec(tmp_path, f"{tmp_path}/in/*", frames=False), tmp_path / "set")
    page = show_set(tmp_path / "set", tmp_path / "set" / "index.html").read_text()
    assert "All items have the same: nothing was drawn." in page
    assert "No item stands out from the others." in page
    (tmp_path / "set" / "items" / "clip0.npz.0.h5").write_bytes(b"damaged")
    assert "it cannot be read" in show_set(tmp_path / "set", tmp_path / "set" / "index.html").read_text()


def test_a_picture_is_of_the_middle(tmp_path: Path) -> None:
    clips(tmp_path / "in", 1)
    made(spec(tmp_path, f"{tmp_path}/in/*", levels="light"), tmp_path / "set")
    [record] = read_manifest(tmp_path / "set")
    picture = picture_of(tmp_path / "set", record)
    assert picture is not None
    assert picture.frame is not None
    # The bar at 4 or 6 of 24 columns, four wide, moving right: ON before it, OFF behind it.
    assert int(picture.frame[0].argmax()) in (4, 6)
    assert picture.events.shape == (16, 24)
    columns = picture.events.sum(axis=0)
    assert columns[7:12].sum() > 0 > columns[2:7].sum()


def test_a_set_without_an_item_is_said(tmp_path: Path) -> None:
    (tmp_path / "manifest.jsonl").write_text('{"name": "a", "variant": 0, "failed": "why"}\n')
    with pytest.raises(UsageError, match=r"has no item: see its manifest\.jsonl for the reasons"):
        show_set(tmp_path, tmp_path / "page.html")
