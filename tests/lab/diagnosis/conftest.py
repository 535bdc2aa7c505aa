"""A small recording with a strong effect hidden in it, and its diagnosis with few twins and candidates."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from tests.generator import draw_base, draw_effect, draw_scene, record

from voltcam_lab.diagnosis.catalogue.catalogue import Candidate, catalogue
from voltcam_lab.diagnosis.search import step
from voltcam_lab.diagnosis.search.identify import Identifiability, identify
from voltcam_lab.diagnosis.search.loop import Diagnosis, diagnose
from voltcam_lab.diagnosis.session import Session, session_of
from voltcam_lab.health import inspect
from voltcam_lab.recordings import Footage, load
from voltcam_simulator import Camera

FEW_TWINS = range(1000, 1008)
WANTED = {"refractory_period", "hot_pixels", "comparator", "leak_mismatch", "vignetting"}


def few(*arguments: object) -> tuple[Candidate, ...]:
    """In place of `catalogue`: enough to be wrong with."""
    return tuple(one for one in catalogue(*arguments) if one.effect in WANTED)  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class Done:
    session: Session
    told: Identifiability
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


@contextmanager
def quick_search() -> Iterator[None]:
    """The search with fewer runs and fewer candidates."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(step, "TWINS", FEW_TWINS)
        patch.setattr(step, "COARSE", range(500, 504))
        patch.setattr("voltcam_lab.diagnosis.session.catalogue", few)
        yield patch


@pytest.fixture(scope="session")
def done(tiny: Footage, tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("done") / ".voltcam-runs"
    sentences: list[str] = []
    with quick_search():
        session = session_of(inspect(tiny), Camera.load("paper"), folder, name="tiny.npz")
        told = identify(session.rig, session.model, session.candidates, FEW_TWINS)
        diagnosis = diagnose(session.rig, session.data, session.model, session.candidates, sentences.append)
    return Done(session, told, diagnosis, sentences)
