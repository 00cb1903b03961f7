"""All live cars of a service: one for each person, a bounded number, each for a bounded time.

They belong to one event loop; nothing here may be called from another thread.
"""

import asyncio
import logging
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Final

from grader.contracts.errors import InfrastructureError, RefusedError
from grader.live.car import LiveCar, new_key

_log = logging.getLogger(__name__)
LIFE_S: Final = 15 * 60.0
IDLE_S: Final = 2 * 60.0
CLIENTS: Final = 8
"""Connections to one car."""

_SOON_S: Final = 60


def websockets_installed() -> bool:
    """Return whether the extra ``live`` is there."""
    return find_spec("wsproto") is not None


@dataclass(slots=True, eq=False)
class LivePlace:
    """A person's car.

    Attributes:
        owner: whose it is, as `grader.use_cases.callers.name_of` says.
        key: what opens it. ends_s: when it ends at the latest, by the event loop's clock.
    """

    owner: str
    key: str
    car: LiveCar
    ends_s: float
    started: "asyncio.Future[None] | None" = None
    life: asyncio.TimerHandle | None = None
    idle: asyncio.TimerHandle | None = None


class LiveCars:
    """Opens cars and ends them: when their time is over, when nobody is connected, when the service stops.

    Args:
        most: how many there may be at once; 0: none are offered.
        life_s: for how long one is there at most. idle_s: for how long while nobody is connected.
        make_car: makes one that is not started.
        may_begin: whether this process may have cars, of several that share a database; it may wait for that one.
    """

    def __init__(
        self,
        most: int,
        *,
        life_s: float = LIFE_S,
        idle_s: float = IDLE_S,
        make_car: Callable[[], LiveCar] = lambda: LiveCar(CLIENTS),
        may_begin: Callable[[], bool] = lambda: True,
    ) -> None:
        self.most = most
        self.life_s = life_s
        self.idle_s = idle_s
        self._make_car = make_car
        self._may_begin = may_begin
        self._places: dict[str, LivePlace] = {}
        self._by_key: dict[str, LivePlace] = {}
        self._stopped = False

    def __len__(self) -> int:
        return len(self._places)

    async def open(self, owner: str) -> LivePlace:
        """Return the owner's car; start one if there is none.

        Raises:
            RefusedError: none are offered here (``live_off``), or there are too many (``live_full``).
            InfrastructureError: it could not be started.
        """
        if self.most and owner not in self._places and not await asyncio.to_thread(self._may_begin):
            _log.warning("a live car was asked for, but another process has them: send /live there")
            raise RefusedError("live_off")
        if not self.most or self._stopped:
            raise RefusedError("live_off")
        place = self._places.get(owner)
        if place is None:
            if len(self._places) >= self.most:
                raise RefusedError("live_full", retry_after_s=_SOON_S)
            place = self._begin(owner)
        assert place.started is not None
        try:
            await asyncio.shield(place.started)
        except InfrastructureError:
            self._forget(place)
            raise
        return place

    def of(self, owner: str) -> LivePlace | None:
        """Return the owner's car, None where there is none."""
        return self._places.get(owner)

    def find(self, key: str) -> LivePlace | None:
        """Return the car that a key opens, None where it opens none."""
        return self._by_key.get(key)

    def close(self, owner: str) -> None:
        """End the owner's car, if there is one."""
        place = self._places.get(owner)
        if place is not None:
            place.car.end()
            self._forget(place)

    def stop(self) -> None:
        """End all cars; from now on none is opened."""
        self._stopped = True
        for owner in tuple(self._places):
            self.close(owner)

    def _begin(self, owner: str) -> LivePlace:
        loop = asyncio.get_running_loop()
        place = LivePlace(owner, new_key(), self._make_car(), loop.time() + self.life_s)
        self._places[owner] = self._by_key[place.key] = place
        place.car.on_empty = lambda: self._wait_for_clients(place)
        place.car.on_join = lambda: self._wait_no_longer(place)
        place.car.on_end = lambda: self._forget(place)
        place.started = loop.create_task(place.car.start())
        place.started.add_done_callback(lambda _: self._wait_for_clients(place))
        place.life = loop.call_later(self.life_s, self._expire, place)
        return place

    def _wait_for_clients(self, place: LivePlace) -> None:
        self._wait_no_longer(place)
        if place.key in self._by_key:
            place.idle = asyncio.get_running_loop().call_later(self.idle_s, self._expire, place)

    def _wait_no_longer(self, place: LivePlace) -> None:
        if place.idle is not None:
            place.idle.cancel()
            place.idle = None

    def _expire(self, place: LivePlace) -> None:
        place.car.end(reason="the time of this car is over")
        self._forget(place)

    def _forget(self, place: LivePlace) -> None:
        self._wait_no_longer(place)
        if place.life is not None:
            place.life.cancel()
        if self._by_key.pop(place.key, None) is not None:
            del self._places[place.owner]
