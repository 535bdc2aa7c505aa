"""Kernels compiled ahead: used where they fit, never where they do not, and with the same events."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import voltcam_simulator
from voltcam_simulator.processor import TARGETS

PACKAGE = Path(voltcam_simulator.__file__).parent
HOST = """
import numba.core.registry
features = numba.core.registry.cpu_target.target_context.codegen().magic_tuple()[2]
"""
MAKE = f"""{HOST}
from voltcam_simulator import ahead, random
from voltcam_simulator.processor import best_target
random.interval_key(1, 2, 3)
target = best_target(features)
wanted = [one for one in ahead.used_signatures() if one[1] == "key_of_interval"] if target else []
ahead.compile_for(target, wanted, ahead.COMPILED / target.name) if target else None
print(target is not None)
"""
USE = """
from voltcam_simulator import random
print(int(random.interval_key(1, 2, 3)), sum(random.key_of_interval.stats.cache_hits.values()))
"""
NO_HOME = """
from pathlib import Path

def no_home():
    raise RuntimeError("Could not determine home directory.")

Path.home = no_home
"""
EVENTS = """
import hashlib
import numpy as np
from voltcam_simulator import Parameters, Simulator
frames = np.random.default_rng(1).integers(0, 256, (8, 24, 32), np.uint8)
simulator, digest = Simulator(32, 24, Parameters.of("noisy"), seed=5), hashlib.sha256()
for i in range(40):
    digest.update(simulator.advance(frames[min(i, 7)], i * 10_000).tobytes())
digest.update(simulator.snapshot()["voltage"].tobytes())
print(simulator.event_bytes > 0, digest.hexdigest())
"""
SIGNATURES = """
import json
import numpy as np
from voltcam_simulator import Parameters, Simulator, ahead, camera_names
before = sorted(map(repr, ahead.used_signatures()))
frames = np.random.default_rng(1).integers(0, 256, (30, 120, 160), np.uint8)
for camera in camera_names():
    simulator = Simulator(160, 120, Parameters.of(camera), seed=3, threads=2)
    for i, frame in enumerate(frames):
        simulator.advance(frame if i % 10 < 5 else frames[5], 20_000 * i)
    for i in range(14):
        simulator.advance(frames[29], 1_000_000 * (i + 1))
    simulator.jump(frames[0].astype(float), 20_000_000)
    simulator.advance(frames[1].astype(float), 20_030_000)
print(json.dumps([len(before), before == sorted(map(repr, ahead.used_signatures()))]))
"""


def run(program: str, package: Path = PACKAGE, **environment: str) -> str:
    """What a program prints, in a process of its own where `package` is the simulator."""
    answer = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        env=os.environ | {"PYTHONPATH": str(package.parent)} | environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert answer.returncode == 0, answer.stderr
    return answer.stdout.strip()


def copied(folder: Path) -> Path:
    """A copy of the package, with nothing compiled ahead."""
    package = folder / "voltcam_simulator"
    return shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__", "compiled"))


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package as a clone has it."""
    return copied(tmp_path_factory.mktemp("plain"))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package with one kernel compiled ahead, for the best target that this machine can run."""
    package = copied(tmp_path_factory.mktemp("made"))
    if run(MAKE, package) != "True":
        pytest.skip("kernels are compiled ahead for x86-64-v3 and better only")
    return package


def test_a_kernel_compiled_ahead_is_used_and_nothing_is_compiled(
    made: Path, plain: Path, tmp_path: Path
) -> None:
    key, hits = run(USE, made, XDG_CACHE_HOME=str(tmp_path)).split()
    assert hits == "1"
    assert list(tmp_path.iterdir()) == []
    assert run(USE, plain, XDG_CACHE_HOME=str(tmp_path)).split() == [key, "0"]  # for this processor, here


@pytest.mark.parametrize("name", ["random.py", "effects/latency.py"])
def test_after_an_edit_of_any_source_none_is_used(made: Path, tmp_path: Path, name: str) -> None:
    edited = tmp_path / "voltcam_simulator"
    shutil.copytree(made, edited)
    with (edited / name).open("a") as source:
        source.write("# edited\n")
    assert run(USE, edited, XDG_CACHE_HOME=str(tmp_path)).split()[1] == "0"


def test_for_a_processor_that_was_asked_for_none_is_used(made: Path, tmp_path: Path) -> None:
    told = {"XDG_CACHE_HOME": str(tmp_path), "NUMBA_CPU_NAME": "x86-64"}
    assert run(USE, made, **told).split()[1] == "0"


@pytest.mark.parametrize(
    "nowhere",
    ["", NO_HOME],
    ids=["cannot be written", "no home"],
)
def test_where_nothing_can_be_kept_kernels_work_all_the_same(made: Path, plain: Path, nowhere: str) -> None:
    """Those of the package are used, others compiled."""
    environment = {"XDG_CACHE_HOME": "" if nowhere else os.devnull}
    assert run(f"{nowhere}\n{USE}", made, **environment).split()[1] == "1"
    assert run(f"{nowhere}\n{USE}", plain, **environment).split()[1] == "0"


def test_events_are_the_same_for_all_targets() -> None:
    """Nothing is reassociated or fused, so width and order of instructions change no bit."""
    features = run(f"{HOST}\nprint(features)").split(",")
    able = [target for target in TARGETS if target.needs <= set(features)]
    host = run(EVENTS)
    assert host.startswith("True")
    for target in able:
        told = {"NUMBA_CPU_NAME": target.name, "NUMBA_CPU_FEATURES": target.features}
        assert run(EVENTS, **told) == host, target.name


def test_what_is_compiled_ahead_is_all_that_the_cameras_need() -> None:
    """Frames of another size, more bands and threads, other intervals: no other signature of any kernel."""
    count, same = json.loads(run(SIGNATURES))
    assert count > 20
    assert same
