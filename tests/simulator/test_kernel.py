"""Kernels on disk: compiled once, also where several processes compile one at once."""

import os
import subprocess
import sys
from pathlib import Path

SIGNATURES = ("int32", "int64", "float32", "float64")
PROGRAM = """
import sys, time
import numpy as np
from numba.core.caching import IndexDataCacheFile
from voltcam_simulator.kernel import kernel

@kernel
def total(values):
    found = values[0] * 0
    for value in values:
        found += value
    return found

write = IndexDataCacheFile._save_index

def slowly(file, overloads):
    time.sleep(0.5)  # in which another process may read the index
    write(file, overloads)

IndexDataCacheFile._save_index = slowly
print("ready", flush=True)
sys.stdin.readline()
for dtype in sys.argv[1:]:
    result = total(np.arange(5, dtype=dtype))
    print(result.dtype if hasattr(result, "dtype") else type(result).__name__, result)
print("from disk:", sum(total.stats.cache_hits.values()))
"""


def run_at_once(program: Path, cache: Path, arguments: list[tuple[str, ...]]) -> list[str]:
    """What each of the processes prints, which begin to compile together."""
    processes = [
        subprocess.Popen(
            [sys.executable, str(program), *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"XDG_CACHE_HOME": str(cache)},
        )
        for words in arguments
    ]
    for process in processes:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
    for process in processes:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    return [process.communicate(timeout=120)[0] for process in processes]


def test_processes_that_compile_a_kernel_at_once_keep_all_they_compiled(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    compiled = run_at_once(program, tmp_path, [(dtype,) for dtype in SIGNATURES])
    assert all("from disk: 0" in said for said in compiled)
    (said,) = run_at_once(program, tmp_path, [SIGNATURES])
    *results, from_disk = said.splitlines()
    assert from_disk == f"from disk: {len(SIGNATURES)}"
    assert [result.split()[1] for result in results] == ["10", "10", "10.0", "10.0"]
