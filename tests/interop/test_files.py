"""Files that other people's libraries read, event by event. `make interop` has all the libraries."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from voltcam_client.encodings import EVENT, Events
from voltcam_client.formats import open_writer, read

EPOCH_US = 1_700_000_000_000_000


@pytest.fixture
def events() -> Events:
    """20 000 events of a 346x260 camera, in 7 s."""
    rng = np.random.default_rng(1)
    events = np.empty(20_000, EVENT)
    events["t"] = np.cumsum(rng.integers(0, 700, events.size))
    events["x"], events["y"] = rng.integers(0, 346, events.size), rng.integers(0, 260, events.size)
    events["p"] = rng.integers(0, 2, events.size)
    return events


def write(path: Path, events: Events) -> Path:
    with open_writer(path, width=346, height=260) as writer:
        for packet in np.array_split(events, 30):
            writer.events(packet)
    return path


def evlib_events(path: Path) -> dict[str, Any]:
    evlib = pytest.importorskip("evlib", reason="evlib is not installed: make interop")
    table = evlib.load_events(str(path)).collect()
    columns = {name: table[name].to_numpy() for name in ("x", "y")}
    return columns | {
        "t": table["t"].dt.total_microseconds().to_numpy(),
        "p": table["polarity"].to_numpy() > 0,
    }


@pytest.mark.parametrize("name", ["a.raw", "a.evt2.raw", "a.h5"])
def test_evlib_reads_binary_files(name: str, events: Events, tmp_path: Path) -> None:
    theirs = evlib_events(write(tmp_path / name, events))
    for column in "txyp":
        np.testing.assert_array_equal(theirs[column], events[column])


def test_evlib_reads_text_and_cuts_the_microsecond_off(events: Events, tmp_path: Path) -> None:
    """It multiplies seconds by a million, and does not round: times are right or one too small."""
    theirs = evlib_events(write(tmp_path / "a.txt", events))
    for column in "xyp":
        np.testing.assert_array_equal(theirs[column], events[column])
    assert set((theirs["t"] - events["t"]).tolist()) <= {-1, 0}


def test_tonic_reads_dsec(events: Events, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Through its own data set, on a folder laid out as DSEC's."""
    DSEC = pytest.importorskip("tonic.datasets", reason="tonic is not installed: make interop").DSEC  # noqa: N806

    events["t"] += EPOCH_US
    name = "zurich_city_00_a"
    folder = tmp_path / "DSEC" / "train" / name / "events_left"
    folder.mkdir(parents=True)
    write(folder / "events.h5", events)
    monkeypatch.setattr(DSEC, "__init__", lambda self: None)
    theirs = dsec_item(DSEC(), tmp_path / "DSEC" / "train", name)
    for column in "txyp":
        np.testing.assert_array_equal(theirs[column], events[column])


def dsec_item(data: Any, folder: Path, name: str) -> Any:
    """Its first recording's events: what its __init__ would have found, less the download."""
    data.location_on_system = str(folder)
    data.split, data.recording_selection, data.data_selection = "train", [name], ["events_left"]
    data.target_selection, data.transform, data.target_transform, data.transforms = [], None, None, None
    return data[0][0][0]["events_left"]


def test_what_tonic_reads_of_aedat2_is_read(events: Events, tmp_path: Path) -> None:
    io = pytest.importorskip("tonic.io", reason="tonic is not installed: make interop")
    records = np.empty((events.size, 2), ">u4")
    records[:, 0] = events["x"].astype("<u4") << 12 | events["y"].astype("<u4") << 22
    records[:, 0] |= events["p"].astype("<u4") << 11
    records[:, 1] = events["t"]
    head = b"#!AER-DAT2.0\r\n# Creation time: System.currentTimeMillis() 1\r\n"
    (tmp_path / "a.aedat").write_bytes(head + records.tobytes())
    _, _, theirs = io.read_davis_346(str(tmp_path / "a.aedat"))
    ours = read(tmp_path / "a.aedat").events
    assert ours.size == theirs.size
    for column in "txyp":
        np.testing.assert_array_equal(ours[column], theirs[column])
