"""One car for all tests of the simulator: episodes must not notice each other."""

from collections.abc import Iterator

import pytest

from grader.sim.driving import Car


@pytest.fixture(scope="session")
def car() -> Iterator[Car]:
    car = Car()
    yield car
    car.close()
