"""A small recording with a strong effect hidden in it, and its diagnosis with few twins and candidates."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from tests.generator import draw_base, draw_effect, draw_scene, record

from voltcam_lab.diagnosis.catalogue.entries import ENTRIES
from voltcam_lab.diagnosis.search.hypothesis import Hypothesis
from voltcam_lab.diagnosis.search.identify import Identifiability, identify
from voltcam_lab.diagnosis.search.loop import Diagnosis, diagnose
from voltcam_lab.diagnosis.search.settings import SearchSettings
from voltcam_lab.diagnosis.search.settings_fit import Runs
from voltcam_lab.diagnosis.search.state import Search, search_of
from voltcam_lab.diagnosis.session import Session, session_of
from voltcam_lab.health import inspect
from voltcam_lab.recordings import Footage, load
from voltcam_simulator import Camera

FEW_RUNS = SearchSettings(runs=Runs(twins=range(1000, 1008), rough_twins=range(500, 504)))
WANTED = {"refractory_period", "hot_pixels", "comparator", "leak_mismatch", "vignetting"}
FEW_ENTRIES = tuple(entry for entry in ENTRIES if entry.effect in WANTED)
"""Of the catalogue: enough to be wrong with."""


@dataclass(frozen=True, eq=False)
class Done:
    session: Session
    search: Search
    identifiability: Identifiability
    diagnosis: Diagnosis
    sentences: list[str]


@pytest.fixture(scope="session")
def tiny_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """2 s of 32 x 24 pixels whose refractory period is 6 ms."""
    rng = np.random.default_rng(5)
    scene, base = draw_scene(rng, 32, 24, 3.0), draw_base(rng, asymmetry=0.0, camera="davis346")
    hidden = [draw_effect(rng, "refractory_period", "strong")]
    made = record(scene, base, hidden, seconds=2.0, seed=3)
    path = tmp_path_factory.mktemp("recording") / "tiny.npz"
    columns = {name: made.events[name] for name in "txyp"}
    np.savez(path, frames=made.frames, t_us=made.frame_t_us, **columns)
    return path


@pytest.fixture(scope="session")
def tiny(tiny_path: Path) -> Footage:
    return load(tiny_path)


@pytest.fixture(scope="session")
def done(tiny: Footage, tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("done") / ".voltcam-runs"
    session = session_of(inspect(tiny), Camera.load("paper"), folder, name="tiny.npz", entries=FEW_ENTRIES)
    sentences: list[str] = []
    search, start = search_of(session, FEW_RUNS, sentences.append), Hypothesis(session.parameters)
    identifiability = identify(session.rig, start, session.candidates, FEW_RUNS)
    return Done(session, search, identifiability, diagnose(search, start), sentences)
