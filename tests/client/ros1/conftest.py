"""One roscore for the tests of a file."""

from collections.abc import Iterator

import pytest
from tests.roscore import Ros1, ros1_running


@pytest.fixture(scope="module")
def ros1(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros1]:
    with ros1_running(tmp_path_factory.mktemp("ros1")) as running:
        yield running
