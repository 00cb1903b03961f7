"""A car of one's own to drive in real time. It is practice: nothing is graded, counted or kept."""

from dataclasses import dataclass
from datetime import datetime, timedelta

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.live.cars import LivePlace
from grader.use_cases.callers import name_of
from grader.use_cases.services import Services


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenCar:
    """A member's car.

    Attributes:
        key: opens it to whoever knows it. expires_at: when it ends at the latest.
        clients: how many are connected.
    """

    key: str
    expires_at: datetime
    clients: int


async def open_car(services: Services, caller: Caller, now_s: float) -> OpenCar:
    """Return the caller's car; start one if there is none. `now_s` is the event loop's clock.

    Raises:
        RefusedError: the caller is no member of a course; no cars are offered, or too many are driven.
        InfrastructureError: the car could not be started.
    """
    return _open_car(services, await services.live.open(_owner(caller)), now_s)


def car_of(services: Services, caller: Caller, now_s: float) -> OpenCar:
    """Return the caller's car. Raises RefusedError: there is none."""
    place = services.live.of(_owner(caller))
    if place is None:
        raise RefusedError("live_not_found")
    return _open_car(services, place, now_s)


def end_car(services: Services, caller: Caller) -> None:
    """End the caller's car and all connections to it; without one nothing happens.

    Raises RefusedError: the caller is no member of a course.
    """
    services.live.close(_owner(caller))


def car_behind(services: Services, key: str, caller: Caller | None) -> LivePlace | None:
    """Return the car that a key opens; None where it opens none, or `caller` is known to be somebody else."""
    place = services.live.find(key)
    if place is None or (caller is not None and name_of(caller) not in (None, place.owner)):
        return None
    return place


def _owner(caller: Caller) -> str:
    name = name_of(caller)
    if caller.person is None or name is None:
        raise RefusedError("no_course")
    return name


def _open_car(services: Services, place: LivePlace, now_s: float) -> OpenCar:
    left = timedelta(seconds=place.ends_s - now_s)
    return OpenCar(key=place.key, expires_at=services.clock() + left, clients=place.car.clients)
