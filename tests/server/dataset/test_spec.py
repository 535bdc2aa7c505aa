"""What a data set is to be: read from a file, refused in a line."""

from pathlib import Path
from typing import Any

import pytest

from voltcam_server.dataset.spec import load_spec, spec_of
from voltcam_server.problems import UsageError


def test_a_pattern_alone_is_an_input(tmp_path: Path) -> None:
    wanted = spec_of({"inputs": "videos/*.mp4"}, "here", tmp_path)
    assert [each.files for each in wanted.inputs] == [f"{tmp_path}/videos/*.mp4"]
    assert (wanted.camera, wanted.format, wanted.variants) == (("davis346",), ".h5", 1)


def test_paths_are_seen_from_the_spec_s_folder(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("temperature_c: 40\n")
    (tmp_path / "spec.yaml").write_text(
        "inputs:\n- {files: in/*, labels: 'labels/{stem}', table: '{folder}/boxes.csv'}\n"
        "camera: [mine.yaml, davis240c]\nupsample: off\n"
    )
    wanted = load_spec(tmp_path / "spec.yaml", {"variants": 3})
    [one] = wanted.inputs
    assert one.labels == f"{tmp_path}/labels/{{stem}}"
    assert one.table == "{folder}/boxes.csv"
    assert wanted.camera == (f"{tmp_path}/mine.yaml", "davis240c")
    assert (wanted.variants, wanted.upsample) == (3, "off")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({}, "inputs: Field required"),
        ({"inputs": []}, "inputs: Value should have at least 1 item"),
        ({"inputs": "a", "paramters": {}}, "paramters: there is no such key, only inputs, camera"),
        ({"inputs": [{"files": "a", "fsp": 3}]}, r"inputs\.0\.fsp: there is no such key, only files"),
        ({"inputs": "a", "upsample": 0}, "upsample: give off, linear, cubic, auto or a number"),
        ({"inputs": "a", "format": ".raw"}, r"format: Input should be '\.h5', '\.aedat4' or '\.npz'"),
        ({"inputs": "a", "variants": 0}, "variants: Input should be greater than or equal to 1"),
        ({"inputs": "a", "camera": "davis999"}, "unknown camera 'davis999'"),
        ({"inputs": "a", "camera": "gone.yaml"}, "gone.yaml"),
        ({"inputs": "a", "parameters": {"comparator": {"theta": 1}}}, "comparator.theta: there is no such"),
        ({"inputs": "a", "parameters": {"comparator": {"theta_on": {"uniform": [0, 1]}}}}, "not 0.0"),
        ({"inputs": "a", "intervals": True}, "davis346 has no intervals"),
    ],
)
def test_what_is_wrong_is_one_line(content: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError, match=words) as refused:
        spec_of(content, "spec.yaml")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [("a: [", "not readable as YAML"), ("- a", "must hold keys"), ("\xff", "must hold keys and values")],
)
def test_a_file_that_is_no_spec_is_said(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "spec.yaml").write_text(text)
    with pytest.raises(UsageError, match=words):
        load_spec(tmp_path / "spec.yaml")
    with pytest.raises(UsageError, match="cannot be read: No such file"):
        load_spec(tmp_path / "gone.yaml")
