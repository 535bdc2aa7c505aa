"""How tests are shared out between processes."""

import pytest


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files run in one process each, whose fixtures are made once; those that share a diagnosis in another."""
    for item in items:
        together = "diagnosis" if "done" in getattr(item, "fixturenames", ()) else str(item.path)
        item.add_marker(pytest.mark.xdist_group(together))
