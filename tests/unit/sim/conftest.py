"""One car for all tests of the simulator: episodes must not notice each other."""

from collections.abc import Iterator

import pytest

from grader.sim.bullet import BulletCar


@pytest.fixture(scope="session")
def car() -> Iterator[BulletCar]:
    car = BulletCar()
    yield car
    car.close()
