"""Camera files on disk: read by name or path, and taken apart."""

from pathlib import Path

import pytest
import yaml
from pydantic import ValidationError

from voltcam_simulator.camera_file import SIDE_LIMIT, SensorSize, camera_names, divided, intervals_of, read


def test_named_cameras_are_files_with_a_name_and_a_size() -> None:
    assert {"davis346", "davis240c", "typical", "paper", "ideal", "noisy"} <= set(camera_names())
    assert camera_names() == sorted(camera_names())
    for name in camera_names():
        size, _parameters = divided(read(name))
        assert size["name"] == name
        SensorSize(**size)


@pytest.mark.parametrize("suffix", [".yaml", ".yml"])
def test_a_file_is_read_as_it_is(suffix: str, tmp_path: Path) -> None:
    content = {"name": "mine", "width": 3, "height": 2, "comparator": {"theta_on": 1.5}}
    path = tmp_path / f"mine{suffix}"
    path.write_text(yaml.safe_dump(content))
    assert read(path) == read(str(path)) == content


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("- 1\n", "not a camera file: it must hold name, width, height"),
        ("", "not a camera file"),
        ("a: [\n", "not readable as YAML"),
        ("[" * 5000, "nested too deep"),
    ],
)
def test_a_file_that_is_none_of_a_camera_is_named_in_one_line(
    tmp_path: Path, content: str, message: str
) -> None:
    path = tmp_path / "broken.yaml"
    path.write_text(content)
    with pytest.raises(ValueError, match=message) as error:
        read(path)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


def test_bytes_that_are_no_text_and_code_in_yaml_are_refused(tmp_path: Path) -> None:
    for content in (b"\xff\xfe\x00name", b"name: !!python/object/apply:os.getcwd []\n"):
        path = tmp_path / "broken.yaml"
        path.write_bytes(content)
        with pytest.raises(ValueError, match="not readable as YAML"):
            read(path)


def test_unknown_names_list_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"'davis999': give one of .*davis346.*, or a \.yaml file"):
        read("davis999")
    with pytest.raises(OSError, match=r"nowhere\.yaml"):
        read("nowhere.yaml")


def test_a_file_is_divided_into_size_and_parameters() -> None:
    size = {"name": "mine", "width": 3, "height": 2}
    parameters = {"comparator": {"theta_on": 1.5}, "temperature_c": 40}
    assert divided(size | parameters) == (size, parameters)
    assert divided(parameters) == ({}, parameters)


def test_intervals_stand_beside_the_parameters() -> None:
    content = {"temperature_c": 40, "intervals": {"comparator.theta_on": [0.8, 1.2]}}
    assert divided(content) == ({}, {"temperature_c": 40})
    assert intervals_of(content) == {"comparator.theta_on": (0.8, 1.2)}
    assert intervals_of({"temperature_c": 40}) == {}


@pytest.mark.parametrize("wrong", [3, [1, 2], {"temperature_c": 3}, {"temperature_c": [1, 2, 3]}])
def test_intervals_have_two_ends(wrong: object) -> None:
    with pytest.raises(ValueError, match=r"intervals: give effect\.parameter: \[low, high\]"):
        intervals_of({"intervals": wrong})


@pytest.mark.parametrize(("given", "missing"), [("width", "height"), ("height", "width")])
def test_one_side_alone_is_refused(given: str, missing: str) -> None:
    with pytest.raises(ValueError, match=f"mine has no {missing}: give width and height, or neither"):
        divided({"name": "mine", given: 3})
    with pytest.raises(ValueError, match=f"the camera has no {missing}"):
        divided({given: 3})


@pytest.mark.parametrize("side", [0, -1, SIDE_LIMIT + 1, "wide", 2.5])
def test_a_sensor_has_sides_that_events_can_hold(side: object) -> None:
    assert SensorSize(width=SIDE_LIMIT, height=1).width == SIDE_LIMIT
    with pytest.raises(ValidationError, match="width"):
        SensorSize.model_validate({"width": side, "height": 1})
