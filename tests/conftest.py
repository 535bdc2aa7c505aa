"""The order in which test files are begun, what daemons of tests are told, numba's simulator of a GPU."""

import os

os.environ.setdefault("NUMBA_ENABLE_CUDASIM", "1")  # read when numba is imported first

import pytest

os.environ.setdefault("VOLTCAM_DV", "127.0.0.1:0")  # free ports: several daemons run at a time

LONG = (
    "lab/diagnosis/test_hidden_effects.py",
    "lab/calibration/test_cli.py",
    "docs/test_pages.py",
    "docs/test_add_an_effect.py",
    "server/test_openapi.py",
    "lab/calibration/test_calibrate.py",
    "lab/diagnosis/test_cli.py",
    "lab/calibration/refine/test_refinement.py",
)
"""Files of more than 20 s. They are begun first, so that at the end no core waits for one of them."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    def place(item: pytest.Item) -> int:
        path = item.path.as_posix()
        return next((i for i, name in enumerate(LONG) if path.endswith(name)), len(LONG))

    items.sort(key=place)
