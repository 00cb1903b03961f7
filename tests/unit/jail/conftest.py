from collections.abc import Iterator

import pytest

from grader.sandbox import Sandbox
from tests.unit.jail.running import make


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    """One sandbox for the tests of a module."""
    with make() as made:
        yield made
