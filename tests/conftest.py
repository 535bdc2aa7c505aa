"""How tests are shared out between processes."""

import pytest


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A file runs in one process, so that its fixtures are made once; so do all that share a diagnosis."""
    for item in items:
        together = "diagnosis" if "done" in getattr(item, "fixturenames", ()) else str(item.path)
        item.add_marker(pytest.mark.xdist_group(together))
