"""When a worker may judge the leases of others: not while they could not have been renewed.

After an outage of the database every lease looks expired to whoever comes back first. The same holds for a worker
that has just been started again by its supervisor, for one whose whole machine was asleep, and where the clock was
set. Whoever could not
renew leases therefore gives everybody the time of one lease. Counted are beats that reached the database, so that
the time of an outage is nobody's time. A database that keeps failing must not strand what dead workers left: after
four leases' worth of such beats leases are judged all the same.
"""

import math
from datetime import datetime

_AT_MOST = 4


class Patience:
    """Counts the beats of one heart; used by its thread only."""

    def __init__(self, lease_s: float, heartbeat_s: float) -> None:
        """Begin patiently: why this worker starts now is not known."""
        self._beats = math.ceil(lease_s / heartbeat_s)
        self._gap_s = lease_s - heartbeat_s  # others beat as often: a longer gap may have cost them a lease
        self._left = self._beats
        self._waited = 0
        self._before: datetime | None = None

    def failed(self) -> None:
        """Note that a beat failed."""
        self._left = self._beats

    def over(self, now: datetime) -> bool:
        """Count a beat that reached the database at `now`; whether leases of others may be judged at it."""
        if self._before is not None and not 0 <= (now - self._before).total_seconds() <= self._gap_s:
            self._left = self._beats
        self._before = now
        if self._left and self._waited < _AT_MOST * self._beats:
            self._left -= 1
            self._waited += 1
            return False
        self._waited = 0
        return True
