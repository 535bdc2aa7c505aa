"""Two cameras that look at one scene, for a diagnosis."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.formats import read
from voltcam_client.packet import EVENT
from voltcam_server.diagnosis import gather as gather_module
from voltcam_server.diagnosis.gather import Sample, main
from voltcam_simulator import Camera
from voltcam_video import SourceRequest

from ..rig import SCENE, moving_frames, save_frames, tiny
from .rig import Bench, diagnosing, publishing


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    with diagnosing(tmp_path) as bench:
        yield bench


def test_two_cameras_are_gathered_on_one_clock(bench: Bench) -> None:
    began_us = time.time_ns() // 1000
    with publishing(SCENE, tiny(comparator={"theta_on": 0.5})) as (_, reference, url):
        bench.control.start_diagnosis(stream=url, seconds=1.2)
        shown = bench.pushed(lambda it: it["figures"] and it["figures"]["events"])
        assert shown["state"] == "gathering"
        waiting = bench.pushed(lambda it: it["progress"] and it["progress"][-1].startswith("process"))
        recording = read(Path(waiting["folder"]) / "gathered.npz")
        last_us = recording.events["t"][-1]
        reference.wait(lambda it: it.events["t"][-1] >= last_us)
        sent = reference.events
    assert waiting["figures"]["events"] == recording.events.size > 0
    first = np.flatnonzero(sent["t"] == recording.events["t"][0])[0]
    np.testing.assert_array_equal(recording.events, sent[first : first + recording.events.size])
    assert recording.frames is not None
    assert recording.frame_t_us is not None
    looked_at = {frame.t_us: frame.image for frame in bench.listener.frames}
    for image, t_us in zip(recording.frames, recording.frame_t_us.tolist(), strict=True):
        np.testing.assert_array_equal(image, looked_at[t_us])
    for t_us in (recording.frame_t_us, recording.events["t"]):
        assert began_us < t_us[0] < t_us[-1] < time.time_ns() // 1000
    overlap_us = min(recording.frame_t_us[-1], last_us) - max(
        recording.frame_t_us[0], recording.events["t"][0]
    )
    assert overlap_us > 0.5e6
    strata = waiting["figures"]["strata"]
    assert [one["from_dn"] for one in strata] == sorted(one["from_dn"] for one in strata)
    assert sum(one["reference"]["on"] for one in strata) > sum(one["here"]["on"] for one in strata) > 0
    assert bench.done("find")["state"] == "done"


def test_rates_are_counted_a_pixel_from_dark_to_bright() -> None:
    image = np.arange(64, dtype=np.uint8).reshape(8, 8)
    y, x = np.divmod(np.arange(64), 8)
    once = np.zeros(64, EVENT)
    once["x"], once["y"], once["p"] = x, y, np.arange(64) >= 32  # OFF of dark pixels, ON of bright ones
    sample = Sample(image)
    sample.count(0, once)
    sample.count(1, np.repeat(once, 3))
    strata = sample.tick()
    assert [(one.from_dn, one.to_dn) for one in strata] == [(0, 15), (16, 31), (32, 47), (48, 63)]
    for i, one in enumerate(strata):
        seen, unseen = (one.here.on, one.here.off) if i >= 2 else (one.here.off, one.here.on)
        three_times = one.reference.on if i >= 2 else one.reference.off
        assert (seen > 0, unseen) == (True, 0)
        assert three_times == pytest.approx(3 * seen, rel=1e-3)


def test_cameras_that_cannot_be_gathered(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def complaint(reference: str) -> str:
        assert main([bench.zmq, reference, str(tmp_path / "out.npz"), "1"]) == 1
        line = capfd.readouterr().err
        assert line.startswith("voltcam: ")
        assert line.count("\n") == 1
        assert not (tmp_path / "out.npz").exists()
        return line

    wide = Camera(name="wide", width=30, height=16)
    with publishing(SCENE, wide) as (_, _, url):
        assert f"the camera at {url} has 30x16 pixels, this one 24x16" in complaint(url)
    frames = moving_frames(200, tiny())
    clip = SourceRequest(uri=save_frames(tmp_path / "in.npz", frames), pace="fast", loop=True)
    with publishing(clip, tiny()) as (_, _, url):
        assert "off this host's clock: both cameras must look at something live" in complaint(url)
    monkeypatch.setattr(gather_module, "PATIENCE_S", 0.2)
    assert "nothing came from tcp://127.0.0.1:1 for 0.2 s" in complaint("tcp://127.0.0.1:1")
