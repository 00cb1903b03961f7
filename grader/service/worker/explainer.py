"""Explains marks: looks for changes of scripts that gain points, behind all gradings.

A worker has one thread for it, with a grading process of its own, of a lower priority than those of slots. Before
each change it grades, it lets every waiting submission go first. So it uses idle time alone, and delays no marks.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from grader.contracts.errors import GraderError, InfrastructureError, SandboxUnavailableError
from grader.contracts.explanation import Explanation
from grader.contracts.grading import GradingJob
from grader.grading.slot import Slot
from grader.store.clock import Clock
from grader.store.explanations import MOST_TRIES, ExplanationClaim, Explanations
from grader.store.rules import StoredRules
from grader.store.work import Doorbell

_log = logging.getLogger(__name__)
_LOOK_S = 0.5
_GLANCE_S = 0.05
_RENEW_S = 10.0
_IDLE_S = 600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Explaining:
    """What explaining takes.

    Attributes:
        explanations: who waits. rules: what is hidden.
        make_grader: returns a new grader; called when there is something to explain.
        clock: tells what is hidden now.
    """

    explanations: Explanations
    rules: StoredRules
    make_grader: Callable[[], Slot]
    clock: Clock


class _LostError(Exception):
    """Somebody else has the grading, it is gone, or the worker stops."""


class Explainer:
    """One thread that explains gradings while the sandbox is ready. Started once and stopped once."""

    def __init__(
        self,
        explaining: Explaining,
        doorbell: Doorbell,
        *,
        ready: Callable[[], bool],
        submissions_wait: Callable[[], bool],
    ) -> None:
        """Prepare; nothing is started.

        Args:
            explaining: what it takes.
            doorbell: rung when something was graded; rung for those who watch.
            ready: whether scripts can be confined.
            submissions_wait: whether a submission is due.
        """
        self._explaining = explaining
        self._doorbell = doorbell
        self._ready = ready
        self._submissions_wait = submissions_wait
        self._stopping = threading.Event()
        self._grader: Slot | None = None
        self._thread = threading.Thread(target=self._work, name="grader-explainer", daemon=True)

    def start(self) -> None:
        """Begin to look for gradings."""
        self._thread.start()

    def stop(self, patience_s: float) -> None:
        """End a trial under way, leave the grading to others, and wait for that at most `patience_s`."""
        self._stopping.set()
        self._doorbell.ring_here()
        grader = self._grader
        if grader is not None:
            grader.abort()
        self._thread.join(patience_s)

    def step(self) -> bool:
        """Explain the grading whose turn it is; False when none waits, or submissions do."""
        if not self._ready() or self._submissions_wait():
            return False
        claim = self._explaining.explanations.claim()
        if claim is None:
            return False
        rules = self._explaining.rules.of(claim.course).of(claim.assignment.id)
        hidden = rules.hidden_at(self._explaining.clock())
        nothing = Explanation(hidden=tuple(sorted(hidden)))
        try:
            if claim.tries > MOST_TRIES:  # whoever looked before ended without a word
                explanation, took_s = nothing, 0.0
            else:
                explanation, took_s = self._explained(claim, hidden)
        except Exception as error:  # no fault of the script's, whatever it is; its marks stand
            self._give_up(claim, error, nothing)
        else:
            self._explaining.explanations.finish(claim, replace(explanation, hidden=nothing.hidden), took_s)
        self._doorbell.ring()
        return True

    def _explained(self, claim: ExplanationClaim, hidden: frozenset[str]) -> tuple[Explanation, float]:
        """Return an explanation, and how long was looked for it, without what others were waited for."""
        if self._grader is None:
            self._grader = self._explaining.make_grader()
        job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=claim.assignment)
        pauses = _Pauses(self._others_wait, lambda: self._explaining.explanations.renew(claim))
        begun_s = time.monotonic()
        explanation = self._grader.explain(job, hidden, pauses.take)
        return explanation, time.monotonic() - begun_s - pauses.waited_s

    def _others_wait(self) -> bool:
        if self._stopping.is_set():
            raise _LostError
        return self._submissions_wait()

    def _give_up(self, claim: ExplanationClaim, error: Exception, nothing: Explanation) -> None:
        """Leave a grading to another try, or unexplained if too many failed."""
        self._close()
        is_lost = isinstance(error, _LostError | SandboxUnavailableError) or self._stopping.is_set()
        if not is_lost:
            level = logging.WARNING if isinstance(error, GraderError) else logging.ERROR
            _log.log(level, "%s is not explained: %s: %s", claim.submission_id, type(error).__name__, error)
        if is_lost or claim.tries < MOST_TRIES:
            self._explaining.explanations.hand_back(claim, counts=not is_lost)
        else:
            self._explaining.explanations.finish(claim, nothing, 0.0)

    def _close(self) -> None:
        grader, self._grader = self._grader, None
        if grader is not None:
            grader.close()

    def _work(self) -> None:
        idle_since_s = time.monotonic()
        while not self._stopping.is_set():
            heard, has_worked = self._doorbell.heard(), False
            try:
                has_worked = self.step()
            except InfrastructureError as error:
                _log.warning("nothing could be explained: %s", error)
            except Exception:
                _log.exception("nothing could be explained")
            if has_worked:
                idle_since_s = time.monotonic()
                continue
            if time.monotonic() - idle_since_s > _IDLE_S:
                self._close()
            self._doorbell.wait(heard, _LOOK_S)
        self._close()


class _Pauses:
    """Lets others go first between two changes that are tried under one claim."""

    def __init__(self, others_wait: Callable[[], bool], renew: Callable[[], bool]) -> None:
        self.waited_s = 0.0
        self._others_wait = others_wait
        self._renew = renew
        self._renewed_s = time.monotonic()

    def take(self) -> None:
        """Wait until nobody else waits. Raises _LostError: the claim is lost, or the worker stops."""
        begun_s = time.monotonic()
        while self._others_wait():
            time.sleep(_GLANCE_S)
            self._keep()
        self._keep()
        self.waited_s += time.monotonic() - begun_s

    def _keep(self) -> None:
        if time.monotonic() - self._renewed_s > _RENEW_S:
            self._renewed_s = time.monotonic()
            if not self._renew():
                raise _LostError
