"""The manifest of a set: whole lines, the newest of an item, sorted at the end."""

import json
from pathlib import Path

import pytest
from tests.server.dataset.engines.deeds import items

from voltcam_server.dataset.item import ItemOutcome, failure
from voltcam_server.dataset.manifest import SetManifest, locked, read_manifest
from voltcam_server.problems import UsageError


def outcome(number: int, events: int) -> ItemOutcome:
    item = items(number + 1)[number]
    return ItemOutcome(item, {"name": item.clip.name, "variant": 0, "events": events, "path": item.path})


def test_lines_come_as_they_are_done_and_are_sorted_at_the_end(tmp_path: Path) -> None:
    manifest = SetManifest(tmp_path)
    for number in (2, 0, 1):
        manifest.add(outcome(number, number))
        assert json.loads((tmp_path / "manifest.jsonl").read_text().splitlines()[-1])["events"] == number
    manifest.finish()
    lines = [json.loads(line) for line in (tmp_path / "manifest.jsonl").read_text().splitlines()]
    assert [line["name"] for line in lines] == ["clip0", "clip1", "clip2"]
    assert lines == read_manifest(tmp_path)


def test_the_newest_line_of_an_item_counts(tmp_path: Path) -> None:
    manifest = SetManifest(tmp_path)
    manifest.add(failure(items(1)[0], "why"))
    again = SetManifest(tmp_path)
    assert again.records["clip0", 0]["failed"] == "why"
    again.add(outcome(0, 5))
    assert [line["events"] for line in read_manifest(tmp_path)] == [5]
    again.finish()
    assert len((tmp_path / "manifest.jsonl").read_text().splitlines()) == 1


def test_half_a_line_of_a_crash_is_cut_off(tmp_path: Path) -> None:
    SetManifest(tmp_path).add(outcome(0, 5))
    whole = (tmp_path / "manifest.jsonl").read_bytes()
    (tmp_path / "manifest.jsonl").write_bytes(whole + whole[:20])
    assert [line["name"] for line in read_manifest(tmp_path)] == ["clip0"]
    again = SetManifest(tmp_path)
    assert (tmp_path / "manifest.jsonl").read_bytes() == whole
    again.add(outcome(1, 6))
    assert [line["events"] for line in read_manifest(tmp_path)] == [5, 6]


def test_what_is_no_manifest_is_not_cut(tmp_path: Path) -> None:
    text = '{"name": "clip0", "variant": 0}\nnotes of mine\n'
    (tmp_path / "manifest.jsonl").write_text(text)
    with pytest.raises(UsageError, match=r"manifest\.jsonl, line 2 is no item's"):
        SetManifest(tmp_path)
    assert (tmp_path / "manifest.jsonl").read_text() == text


def test_a_lock_is_given_back_and_errors_go_through(tmp_path: Path) -> None:
    with pytest.raises(KeyError), locked(tmp_path):
        raise KeyError
    with (
        locked(tmp_path),
        pytest.raises(UsageError, match="another program makes this set"),
        locked(tmp_path),
    ):
        raise AssertionError("there were two")
