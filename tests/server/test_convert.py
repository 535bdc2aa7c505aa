"""`voltcam convert`: files in, event files out."""

import os
import signal
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from voltcam_client.encodings import EVENT
from voltcam_client.formats import open_writer, read
from voltcam_server.convert import Conversion, convert
from voltcam_server.problems import UsageError
from voltcam_simulator import Camera, Simulator
from voltcam_video import SourceRequest

from .process import voltcam, voltcam_path
from .rig import PATIENCE_S, moving_frames, save_frames, tiny, until

DATA = Path(os.environ.get("VOLTCAM_DATA", Path(__file__).parents[3] / "shared" / "data"))


def job(source: str | Path, output: Path, camera: Camera | None = None) -> Conversion:
    return Conversion(
        SourceRequest(uri=str(source), pace="fast"), camera or tiny(), output, seed=2, upsample="linear"
    )


@pytest.mark.parametrize("start_us", [0, 1_700_000_000_000_000])
@pytest.mark.parametrize("suffix", [".npz", ".txt", ".csv", ".raw", ".aedat4"])
def test_every_frame_is_simulated(tmp_path: Path, suffix: str, start_us: int) -> None:
    camera, output = tiny(), tmp_path / f"out{suffix}"
    frames = moving_frames(50, camera)
    words = convert(job(save_frames(tmp_path / "in.npz", frames, start_us=start_us), output))
    simulator = Simulator(24, 16, camera.parameters, seed=2)
    expected = [simulator.advance(image, start_us + 10_000 * i) for i, image in enumerate(frames)]
    np.testing.assert_array_equal(read(output).events, np.concatenate(expected))
    assert f"{sum(map(len, expected))} events from 50 frames" in words


def test_grey_levels_of_a_video_are_decoded(tmp_path: Path) -> None:
    camera, output = tiny(), tmp_path / "out.npz"
    frames = moving_frames(20, camera)
    asked = job(save_frames(tmp_path / "in.npz", frames), output)
    convert(replace(asked, source=asked.source.model_copy(update={"levels": "video"})))
    decoding = camera.parameters.changed({"input_response": {"gamma_exponent": 2.2}})
    simulator = Simulator(24, 16, decoding, seed=2)
    expected = [simulator.advance(image, 10_000 * i) for i, image in enumerate(frames)]
    np.testing.assert_array_equal(read(output).events, np.concatenate(expected))


@pytest.mark.parametrize("suffix", [".npz", ".h5", ".bag", ".dvs.mcap", ".db3"])
def test_a_copy_has_events_and_frames_and_simulates_nothing(tmp_path: Path, suffix: str) -> None:
    events = np.array([(5, 1, 2, True), (90_000, 3, 1, False)], EVENT)
    with open_writer(tmp_path / "in.npz", width=24, height=16) as writer:
        writer.events(events)
        writer.frame(np.full((16, 24), 7, np.uint8), 50)
    output = tmp_path / f"out{suffix}"
    words = convert(replace(job(tmp_path / "in.npz", output), copy=True))
    assert words == f"{output}: 2 events copied from {tmp_path / 'in.npz'}, nothing simulated"
    recording = read(output)
    np.testing.assert_array_equal(recording.events, events)
    assert recording.frames is not None
    assert (recording.frames.shape, recording.width, recording.height) == ((1, 16, 24), 24, 16)


def test_what_the_format_cannot_carry_is_said(tmp_path: Path) -> None:
    with open_writer(tmp_path / "in.npz", width=24, height=16) as writer:
        writer.frame(np.full((16, 24), 7, np.uint8), 50)
    for suffix, lost in ((".raw", "frames"), (".es", "frames and the time of day")):
        words = convert(replace(job(tmp_path / "in.npz", tmp_path / f"out{suffix}"), copy=True))
        assert words.endswith(f"; without {lost}, which {suffix} cannot carry")


def test_frames_are_fitted_to_the_camera(tmp_path: Path) -> None:
    output = tmp_path / "out.npz"
    large = moving_frames(5, Camera(name="large", width=200, height=100))
    convert(job(save_frames(tmp_path / "in.npz", large), output))
    recording = read(output)
    assert (recording.width, recording.height) == (24, 16)


def test_a_source_that_breaks_off_keeps_what_came_before(tmp_path: Path) -> None:
    frames = moving_frames(10, tiny()).astype(np.float32)
    frames[6, 3, 3] = np.nan
    np.savez(tmp_path / "in.npz", frames=frames, t_us=1000 * np.arange(10))
    output = tmp_path / "out.txt"
    with pytest.raises(UsageError) as caught:
        convert(job(tmp_path / "in.npz", output))
    text = str(caught.value)
    assert "frames[6]" in text
    assert "\n" not in text
    simulator = Simulator(24, 16, tiny().parameters, seed=2)
    expected = np.concatenate([simulator.advance(image, 1000 * i) for i, image in enumerate(frames[:6])])
    np.testing.assert_array_equal(read(output).events, expected)
    assert f"the {expected.size} events before it are kept in {output}" in text


@pytest.mark.parametrize("stamps", [[0, 1000, 1000, 2000], [0, 1000, 500, 2000]])
def test_stamps_that_do_not_advance_are_named(tmp_path: Path, stamps: list[int]) -> None:
    np.savez(tmp_path / "in.npz", frames=moving_frames(4, tiny()), t_us=stamps)
    with pytest.raises(UsageError, match=r"t_us\[2\]"):
        convert(job(tmp_path / "in.npz", tmp_path / "out.txt"))


def test_a_recording_without_frames_is_copied(tmp_path: Path) -> None:
    convert(job(save_frames(tmp_path / "in.npz", moving_frames(9, tiny())), tmp_path / "events.npz"))
    for source, output in (
        ("events.npz", "events.txt"),
        ("events.txt", "events.raw"),
        ("events.raw", "back.csv"),
    ):
        words = convert(job(tmp_path / source, tmp_path / output))
        assert "nothing simulated" in words
        np.testing.assert_array_equal(read(tmp_path / output).events, read(tmp_path / "events.npz").events)


def test_of_a_copy_the_first_seconds_are_enough(tmp_path: Path) -> None:
    convert(job(save_frames(tmp_path / "in.npz", moving_frames(9, tiny())), tmp_path / "EVENTS.TXT"))
    assert "nothing simulated" in convert(
        replace(job(tmp_path / "EVENTS.TXT", tmp_path / "first.txt"), seconds=0.05)
    )
    events = read(tmp_path / "EVENTS.TXT").events
    first = events[events["t"] <= events["t"][0] + 50_000]
    assert 0 < first.size < events.size
    np.testing.assert_array_equal(read(tmp_path / "first.txt").events, first)


def test_a_recording_of_others_is_simulated_from_its_frames(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py", reason="h5py is in the extra [lab]")
    frames, t_us = moving_frames(20, tiny()), 10_000 * np.arange(20)
    with h5py.File(tmp_path / "in.h5", "w") as file:
        for name in "txyp":
            file[f"events/{name}"] = [1]
        file["frames"], file["t_us"] = frames, t_us
    convert(job(tmp_path / "in.h5", tmp_path / "out.npz"))
    convert(job(save_frames(tmp_path / "in.npz", frames), tmp_path / "same.npz"))
    made = read(tmp_path / "out.npz").events
    assert made.size > 0
    np.testing.assert_array_equal(made, read(tmp_path / "same.npz").events)


def test_a_recording_of_others_without_frames_is_copied(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py", reason="h5py is in the extra [lab]")
    with h5py.File(tmp_path / "in.h5", "w") as file:
        for name, value in zip("txyp", (7, 3, 2, 1), strict=True):
            file[f"events/{name}"] = [value]
    assert "nothing simulated" in convert(job(tmp_path / "in.h5", tmp_path / "out.txt"))
    assert (tmp_path / "out.txt").read_text() == "0.000007 3 2 1\n"


def test_an_unfinished_recording_is_recovered(tmp_path: Path) -> None:
    frames = moving_frames(4, tiny())
    writer = open_writer(tmp_path / "cut.npz", width=24, height=16)
    writer.events(Simulator(24, 16).advance(frames[0], 0))
    for i, image in enumerate(frames):
        writer.frame(image, 1000 * i)
    # No close: as a killed process leaves it.
    convert(job(tmp_path / "cut.npz.partial", tmp_path / "saved.npz"))
    saved = read(tmp_path / "saved.npz")
    np.testing.assert_array_equal(saved.frames, frames)
    writer.close()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none.mp4", "out.npz"], "none.mp4"),
        (["scene", "out.npz"], "scene does not end by itself: give --seconds"),
        (["in.npz", "out.mp3"], "'.mp3'"),
        (
            ["in.npz", "there.npz"],
            "there.npz exists already: choose another name, or remove it (convert and record: --overwrite)",
        ),
        (
            ["in.npz", "out.npz", "--set", "comparator.theta=1"],
            "parameters.comparator.theta: there is no such key",
        ),
        (["in.npz", "out.npz", "--camera", "davis128"], "unknown camera 'davis128'"),
        (["in.npz", "out.npz", "--camera", "none.yaml"], "none.yaml cannot be read"),
        (["in.npz", "out.npz", "--seed", "-1"], "command line: seed: "),
    ],
)
def test_errors_are_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    save_frames(tmp_path / "in.npz", moving_frames(3, tiny()))
    (tmp_path / "there.npz").write_text("precious")
    done = voltcam("convert", *arguments)
    assert (done.returncode, done.stdout) == (1, "")
    assert words in done.stderr
    assert done.stderr.count("\n") == 1
    assert (tmp_path / "there.npz").read_text() == "precious"
    assert not (tmp_path / "out.npz").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_a_whole_file(tmp_path: Path, number: int) -> None:
    output = tmp_path / "out.npz"
    command = [voltcam_path(), "convert", "scene", str(output), "--seconds", "1e6"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    spooled = tmp_path / "out.npz.partial" / "events.bin"
    until(lambda: spooled.exists() and spooled.stat().st_size, "events are written")
    process.send_signal(number)
    words, errors = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, errors) == (0, "")
    assert f"{read(output).events.size} events from" in words


def test_real_frames_give_images_like_the_real_events(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Frames of a DAVIS240C against the events it gave: event counts per pixel over 50 ms."""
    folder = DATA / "slider_depth"
    if not folder.is_dir():
        pytest.skip(f"no recording at {folder}: set VOLTCAM_DATA")
    camera = Camera.load("davis240c")
    request = SourceRequest(uri=str(folder), pace="fast")
    seconds, x, y = np.loadtxt(folder / "events.txt", usecols=(0, 1, 2), max_rows=150_000).T
    starts = np.arange(100_000, 500_000, 50_000)

    def counts(t_us: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        edges = [*starts, starts[-1] + 50_000], range(181), range(241)
        return np.histogramdd((t_us, y, x), edges)[0].reshape(starts.size, -1)

    real, likeness = counts(seconds * 1e6, x, y), {}
    for upsample in ("linear", "cubic", "auto"):
        output = tmp_path / f"{upsample}.npz"
        convert(Conversion(request, camera, output, seed=1, seconds=0.6, upsample=upsample))
        made = read(output).events
        simulated = counts(made["t"], made["x"], made["y"])
        same = np.diag(np.corrcoef(simulated, real)[: starts.size, starts.size :])
        likeness[upsample] = float(np.median(same))
        assert same.min() > 0.5
    with capsys.disabled():
        print(f"\nslider_depth: correlation of 50 ms event-count images {likeness}")  # noqa: T201
    assert likeness["auto"] > likeness["linear"] + 0.03 > 0.58


def test_the_cubic_is_nearer_to_light_that_never_stops(tmp_path: Path) -> None:
    """Without noise, against the same light in steps of 50 us: a pixel that brightens ever faster."""
    off = {"contrast_response": {"k1": 5}, "photon_noise": {"k3": 0}, "junction_leak": {"k4_per_us": 0}}
    camera = tiny(**off, parasitic_photocurrent={"k5_per_dn_us": 0}, leak_noise={"k6": 0})

    def frames(t_us: np.ndarray) -> np.ndarray:
        levels = 25 * np.exp(2.3 * (t_us / 50_000) ** 3) - 20
        return np.broadcast_to(levels[:, None, None], (t_us.size, 16, 24)).astype(np.float32)

    fine = np.arange(0, 50_001, 50)
    simulator = Simulator(24, 16, camera.parameters, seed=2)
    steps = zip(frames(fine), fine.tolist(), strict=True)
    true_us = np.concatenate([simulator.advance(image, t_us) for image, t_us in steps])["t"]
    miss_us = {}
    for upsample in ("linear", "cubic"):
        source = save_frames(tmp_path / f"{upsample}-in.npz", frames(np.arange(0, 50_001, 10_000)))
        output = tmp_path / f"{upsample}.npz"
        convert(replace(job(source, output, camera), upsample=upsample))
        found_us = read(output).events["t"]
        assert found_us.size == true_us.size > 3000
        miss_us[upsample] = float(np.abs(found_us - true_us).mean())
    assert miss_us["cubic"] < 0.5 * miss_us["linear"], miss_us
