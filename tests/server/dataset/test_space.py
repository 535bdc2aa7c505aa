"""How much of the disk a set will take."""

import shutil
from pathlib import Path

import pytest
from tests.server.dataset.rig import FRAMES, HereEngine, clips, made, spec

from voltcam_server.dataset.clips import clips_of, items_of
from voltcam_server.dataset.item import Making
from voltcam_server.dataset.space import DiskSpace, in_words, space_for
from voltcam_server.problems import UsageError


@pytest.mark.parametrize("suffix", [".npz", ".aedat4"])
def test_it_is_about_what_the_set_then_takes(tmp_path: Path, suffix: str) -> None:
    wanted = spec(
        tmp_path, f"{clips(tmp_path / 'in', 6)}/*", format=suffix, levels="light",
        parameters={"comparator": {"theta_on": 0.02, "theta_off": 0.02}},
    )  # fmt: skip
    made(wanted, tmp_path / "set", HereEngine())
    taken = sum(path.stat().st_size for path in (tmp_path / "set" / "items").iterdir())
    making = Making(tmp_path, wanted.cameras(), "exact", "cpu", "cubic", "crop", None, True)
    items = items_of(wanted, clips_of(wanted))
    space = space_for(items, [FRAMES] * len(items), making)
    assert 0.4 * taken < space.set_bytes < 2.5 * taken
    assert space_for(items, [10 * FRAMES] * 6, making).set_bytes == pytest.approx(10 * space.set_bytes)


def test_what_does_not_fit_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = shutil.disk_usage(tmp_path)._replace(free=3_000_000_000)
    monkeypatch.setattr("voltcam_server.dataset.space.shutil.disk_usage", lambda _: usage)
    DiskSpace(2e9, 1e8).check(tmp_path, 9)
    with pytest.raises(UsageError, match=r"takes about 3\.2 GB, and 3\.0 GB are free: make room"):
        DiskSpace(2e9, 1e8).check(tmp_path, 12)
    assert in_words(2.4e7) == "24 MB"
