"""The report of a calibration whose findings are written down."""

from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from tests.lab.health.made import HEIGHT, WIDTH, healthy, well

from voltcam_lab.calibration.calibrated import Calibrated
from voltcam_lab.calibration.estimates import Estimate
from voltcam_lab.calibration.page import write_report
from voltcam_lab.calibration.reading import Reading
from voltcam_lab.health.finding import Finding
from voltcam_lab.light.scene import scene_of
from voltcam_lab.windows import Mask
from voltcam_simulator import Camera, Parameters

SURE = Estimate("contrast_response", "k1", 5.0, 4.0, 6.0, (1.0, 25.0), 0.9)
OPEN = Estimate("photon_noise", "k3", 1e-4, 1e-5, 1e-3, (2e-5, 5e-4), 0.1)
MOVED = (("comparator.theta_on", 1.0, 1.234),)


class Reader(HTMLParser):
    """Rows of the tables, items, headings, captions, the verdict with its class, and all that is loaded."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.texts: dict[str, list[str]] = {}
        self.verdict = ""
        self.loaded: list[str] = []
        self._open: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.loaded += [given[name] or "" for name in ("src", "href") if name in given]
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
        elif tag == "p" and (given.get("class") or "").startswith("verdict"):
            self.verdict = given["class"] or ""
        self.texts.setdefault(tag, []).append("")
        self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        while self._open and self._open.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        for tag in self._open:
            self.texts[tag][-1] += data
        if {"td", "th"} & set(self._open):
            self.rows[-1][-1] += data

    def row(self, *beginning: str) -> list[str]:
        """The rest of the only row that begins so."""
        (found,) = [row for row in self.rows if row[: len(beginning)] == list(beginning)]
        return found[len(beginning) :]


@pytest.fixture(scope="module")
def found() -> Calibrated:
    """A second of 64 x 48 pixels; half of the time between frames is left out."""
    recording, inspection = healthy(), well()
    frames, t_us = recording.frames[:41], recording.frame_t_us[:41]
    inside = (recording.events["t"] >= t_us[0]) & (recording.events["t"] <= t_us[-1])
    mask = Mask(np.stack([t_us[:-1], t_us[:-1] + 12_500], axis=1))
    keep = np.ones((HEIGHT, WIDTH), np.bool_)
    reading = Reading(recording.events[inside], scene_of(frames, t_us, "linear"), keep, mask)
    camera = Camera(name="mine", width=WIDTH, height=HEIGHT, parameters=Parameters.of("paper"))
    notes = ("40 frames of <walk>.", "k1 & k2 are correlated.")
    return Calibrated(
        camera, "exact", inspection.health, reading, mask, notes, estimates=(SURE, OPEN), moved=MOVED
    )


@pytest.fixture
def read(tmp_path: Path) -> Callable[[Calibrated], Reader]:
    def written(found: Calibrated) -> Reader:
        path = write_report(found, "walk.npz", tmp_path / "report", seed=1)
        assert path == tmp_path / "report" / "report.html"
        return Reader(path.read_text(encoding="utf-8"))

    return written


def test_the_page_says_what_was_found_and_how_well_it_fits(
    found: Calibrated, read: Callable[[Calibrated], Reader]
) -> None:
    page = read(found)
    assert page.texts["h1"] == ["Camera calibrated from walk.npz"]
    assert page.verdict == "verdict good"
    (verdict,) = [text for text in page.texts["p"] if "parameters are fixed" in text]
    assert verdict.startswith("1 of 2 parameters are fixed by this recording. This recording can be used")
    assert page.row("contrast_response", "k1") == ["5", "4", "6", "data"]
    assert page.row("photon_noise", "k3") == ["0.0001", "1e-05", "0.001", "prior"]
    assert page.row("comparator.theta_on") == ["1", "1.23"]
    for heading in ("Parameters", "Moved to behave as the recording", "Measured and simulated"):
        assert heading in page.texts["h2"]
    assert len(page.texts["img"]) == 3


def test_notes_are_text_the_first_below_the_title(
    found: Calibrated, read: Callable[[Calibrated], Reader]
) -> None:
    page = read(found)
    assert page.texts["li"] == ["k1 & k2 are correlated."]
    assert any("40 frames of <walk>." in text for text in page.texts["p"])


def test_events_are_counted_where_they_were_not_left_out(
    found: Calibrated, read: Callable[[Calibrated], Reader]
) -> None:
    """Of the recording exactly; simulated, more with nothing left out."""
    events = found.reading.events
    phase_us = (events["t"] - found.reading.scene.taken_us[0]) % 25_000
    late = events[phase_us >= 12_500]
    masked = read(found)
    counted = [str(np.count_nonzero(late["p"] == on)) for on in (True, False)]
    assert masked.row("recording") == counted
    whole = read(replace(found, mask=Mask()))
    assert whole.row("recording") == [str(np.count_nonzero(events["p"] == on)) for on in (True, False)]
    for name in ("recording", "exact, calibrated"):
        less, more = (sum(map(int, page.row(name))) for page in (masked, whole))
        assert 0 < less < more


def test_health_has_each_finding_and_each_answer(
    found: Calibrated, read: Callable[[Calibrated], Reader]
) -> None:
    page = read(found)
    for one in found.health.findings:
        assert page.row(one.name) == [one.severity, one.words]
    for answer in found.health.determinations:
        assert page.row(", ".join(answer.parameters)) == [answer.answer, answer.words]


def test_without_estimates_there_is_no_table_of_them(
    found: Calibrated, read: Callable[[Calibrated], Reader]
) -> None:
    """The paper's method gives no intervals."""
    page = read(replace(found, method="paper", estimates=(), moved=()))
    assert "Parameters" not in page.texts["h2"]
    assert "Moved to behave as the recording" not in page.texts["h2"]
    assert page.verdict == "verdict good"
    assert page.row("paper, calibrated")


def test_where_nothing_is_fixed_or_the_recording_is_of_no_use_the_page_warns(
    found: Calibrated, read: Callable[[Calibrated], Reader]
) -> None:
    page = read(replace(found, estimates=(OPEN,)))
    bad = replace(found.health, findings=(Finding("clock", "fatal", "of another clock", {}),))
    assert page.verdict == read(replace(found, health=bad)).verdict == "verdict warn"
    assert any(text.startswith("0 of 1 parameters are fixed") for text in page.texts["p"])


def test_the_page_needs_nothing_beside_it(found: Calibrated, read: Callable[[Calibrated], Reader]) -> None:
    page = read(found)
    assert page.loaded
    assert all(address.startswith(("data:", "#")) for address in page.loaded)
    assert "script" not in page.texts
