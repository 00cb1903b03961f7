"""The heart of a worker: keeps its claims alive, lets go of those it lost, mends what others left, and reports.

A beat does five things, in this order: it renews the leases of what the slots grade; it tries a sandbox that was
not ready; it says how the worker is; it mends what crashed workers left; and it frees the slot that is kept for
those whose turn it is, if what it grades takes long while they wait. What matters most to the gradings
under way comes first, so that trouble with what comes later takes nothing from them.

A claim that is lost never comes back: somebody else grades the submission, or has graded it. Its slot
abandons it at the second beat in a row that finds it lost: at the first, the slot may just have stored its result.
"""

import logging
import math
import threading
import time
from collections.abc import Sequence, Set
from datetime import datetime

from grader.contracts.submission import Claim, WorkerState
from grader.service.worker.slots import SandboxHealth, WorkerParts, WorkerSlot

_log = logging.getLogger(__name__)
_LOOK_S = 0.5  # between looks whether a kept slot should give way
_AT_MOST = 4  # leases: after this long, leases are ended even while the database keeps failing


class Heart:
    """Beats in a thread of its own, for as long as the worker lives. Started once and stopped once."""

    def __init__(
        self,
        worker_id: str,
        slots: Sequence[WorkerSlot],
        parts: WorkerParts,
        sandbox: SandboxHealth,
        heartbeat_s: float,
    ) -> None:
        """Prepare; the heart does not beat yet.

        Args:
            worker_id: as which the worker is reported.
            slots: whose claims are renewed.
            parts: the store, and who observes gradings.
            sandbox: tried again at every beat while it is not ready and no slot is busy.
            heartbeat_s: pause between two beats.
        """
        self._worker_id = worker_id
        self._slots = slots
        self._parts = parts
        self._sandbox = sandbox
        self._heartbeat_s = heartbeat_s
        self._patience = Patience(parts.queue.lease_s, heartbeat_s)
        self._started_at = parts.clock()
        self._lost: Set[Claim] = frozenset()  # at the latest beat that was answered
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._beat_on, name="grader-heart", daemon=True)

    def start(self) -> None:
        """Begin to beat."""
        self._thread.start()

    def stop(self, patience_s: float) -> None:
        """Beat no more; wait at most `patience_s` for a beat under way."""
        self._stopped.set()
        self._thread.join(patience_s)

    def beat(self) -> None:
        """Do what a heart does, once.

        Raises InfrastructureError: the database does not answer. What was not done is done at the next beat.
        """
        try:
            self._beat()
        except Exception:
            self._patience.failed()
            raise

    def _beat(self) -> None:
        busy = self._renew()
        # only while nothing runs: trying may take longer than a lease
        if self._slots and not busy and not self._sandbox.state.ready and self._sandbox.try_out():
            self._parts.doorbell.ring()
        if not self._stopped.is_set():  # else this beat took so long that the worker has left meanwhile
            self._parts.workers.report(self._state(busy))
        self._mend()
        self._give_way()

    def _give_way(self) -> None:
        for slot in self._slots:
            slot.give_way()

    def _renew(self) -> int:
        """Renew what the slots hold; return how many are busy."""
        held = [(slot, claim) for slot in self._slots if (claim := slot.claim) is not None]
        claims = {claim for _, claim in held}
        lost = claims - self._parts.queue.renew(claims) if claims else frozenset()
        for slot, claim in held:
            if claim in lost & self._lost:
                slot.abandon(claim)
        self._lost = lost
        return len(held)

    def _mend(self) -> None:
        queue = self._parts.queue
        if not self._patience.count_beat(self._parts.clock()):
            queue.bring_forward()
            return
        mended = queue.reconcile()
        if mended.requeued or mended.given_up:
            level = logging.ERROR if mended.given_up else logging.WARNING
            _log.log(level, "%d lost gradings queued again, %d given up", mended.requeued, mended.given_up)
            self._parts.metrics.retried(mended.requeued)
            self._parts.metrics.given_up(mended.given_up)
            self._parts.doorbell.ring()

    def _state(self, busy: int) -> WorkerState:
        sandbox = self._sandbox.state
        return WorkerState(
            id=self._worker_id,
            slots=len(self._slots),
            busy=busy,
            sandbox_ready=sandbox.ready,
            isolation=sandbox.isolation,
            detail=sandbox.detail,
            started_at=self._started_at,
            seen_at=self._parts.clock(),
        )

    def _beat_on(self) -> None:
        next_beat_s = time.monotonic()
        while True:
            try:
                if time.monotonic() >= next_beat_s:
                    next_beat_s = time.monotonic() + self._heartbeat_s
                    self.beat()
                else:  # between beats, so that a kept slot gives way sooner than the next beat
                    self._give_way()
            except Exception as error:  # a heart that stopped would give away every grading of this worker
                if not self._stopped.is_set():  # then nobody waits for it any more
                    _log.warning("heartbeat failed: %s", error)
            left_s = max(next_beat_s - time.monotonic(), 0.0)
            if self._stopped.wait(min(left_s, _LOOK_S)):
                return


class Patience:
    """Says when a worker may end the leases of others: not while they could not have renewed them.

    After an outage of the database every lease looks expired to the worker that comes back first. The same
    holds for a worker that was just restarted, for a machine that was asleep, and after the clock was set. So
    whoever could not renew its own leases gives everybody the time of one lease. Only beats that reached the
    database are counted, because the time of an outage helps nobody. A database that keeps failing must not
    strand what dead workers left: after four leases' worth of such beats leases are ended all the same.

    Counts the beats of one heart; used by its thread only.
    """

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

    def count_beat(self, now: datetime) -> bool:
        """Count a beat that reached the database at `now`; return whether it may end leases of other workers."""
        if self._before is not None and not 0 <= (now - self._before).total_seconds() <= self._gap_s:
            self._left = self._beats
        self._before = now
        if self._left and self._waited < _AT_MOST * self._beats:
            self._left -= 1
            self._waited += 1
            return False
        self._waited = 0
        return True
