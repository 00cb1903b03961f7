"""The rules of an assignment applied: what is accepted, what lateness costs, which attempt counts.

Pure functions of instants and rules, with no clock and no store, so that asking again tomorrow gives the same
answer.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, time, timedelta
from zoneinfo import ZoneInfo

from grader.contracts.policy import (
    NO_EXTENSION,
    AssignmentPolicy,
    Attempt,
    Counts,
    Extension,
    Refusal,
)

_DAY_S = 86_400
_CENT = 2  # scores are rounded to 1e-2, as rubric items are


@dataclass(frozen=True, slots=True, kw_only=True)
class Counted:
    """The attempt that counts, and what of its score is kept after lateness (`score`)."""

    attempt: Attempt
    score: float


def due_for(policy: AssignmentPolicy, extension: Extension = NO_EXTENSION) -> datetime | None:
    """Return the due date of one student: never earlier than everybody's. None: there is none."""
    if policy.due is None or extension.due is None:
        return policy.due
    return max(policy.due, extension.due)


def late_s(policy: AssignmentPolicy, extension: Extension, received_at: datetime) -> float:
    """Return how many seconds after the student's due date `received_at` is; 0.0 when it is not."""
    due = due_for(policy, extension)
    return 0.0 if due is None else max((received_at - due).total_seconds(), 0.0)


def kept_share(policy: AssignmentPolicy, extension: Extension, received_at: datetime) -> float:
    """Return the share of its points that a submission keeps, in [0, 1]; it never rises with time."""
    seconds = late_s(policy, extension, received_at)
    if seconds <= 0.0:
        return 1.0
    if policy.late.kind == "linear":
        begun_days = -(-seconds // _DAY_S)
        return max(1.0 - begun_days * policy.late.per_day, 0.0)
    if policy.late.kind == "steps":
        passed = [step.keep for step in policy.late.steps if seconds > step.after_s]
        return passed[-1] if passed else 1.0
    return 1.0


def kept_score(policy: AssignmentPolicy, extension: Extension, score: float, received_at: datetime) -> float:
    """Return what of `score` is kept after lateness, rounded as scores are."""
    return round(score * kept_share(policy, extension, received_at), _CENT)


def refusal(
    policy: AssignmentPolicy,
    extension: Extension,
    earlier: Sequence[Attempt],
    received_at: datetime,
    zone: ZoneInfo,
) -> Refusal | None:
    """Return why an upload received at `received_at` is refused, or None.

    Args:
        policy: the rules.
        extension: what this student gets beyond them.
        earlier: the student's attempts so far; those that cost nothing are not counted.
        received_at: instant of the upload.
        zone: whose calendar days the limit per day means.
    """
    if policy.opens is not None and received_at < policy.opens:
        return Refusal(code="not_open_yet", until=policy.opens)
    due = due_for(policy, extension)
    if (
        due is not None
        and policy.accept_late_s is not None
        and received_at > due + timedelta(seconds=policy.accept_late_s)
    ):
        return Refusal(code="closed")
    costly = [attempt for attempt in earlier if attempt.costs]
    left = attempts_left(policy, extension, costly)
    if left is not None and left <= 0:
        return Refusal(code="no_attempts_left")
    return _too_many_today(policy, costly, received_at, zone)


def attempts_left(policy: AssignmentPolicy, extension: Extension, earlier: Sequence[Attempt]) -> int | None:
    """Return how many attempts a student has left in all; None: any number."""
    if policy.attempts is None:
        return None
    used = sum(attempt.costs for attempt in earlier)
    return max(policy.attempts + extension.extra_attempts - used, 0)


def counting(policy: AssignmentPolicy, extension: Extension, attempts: Sequence[Attempt]) -> Counted | None:
    """Return the attempt that counts, None while there is none with a score.

    Of attempts that keep equally much the first counts. With ``last`` it is the last one that is graded.
    """
    graded = sorted(
        (one for one in attempts if one.costs and one.score is not None),
        key=lambda one: (one.received_at, one.id),
    )
    if policy.counts is Counts.BEST_BEFORE_DUE:
        graded = [one for one in graded if late_s(policy, extension, one.received_at) <= 0.0]
    if not graded:
        return None
    kept = [
        Counted(attempt=one, score=kept_score(policy, extension, one.score or 0.0, one.received_at))
        for one in graded
    ]
    return kept[-1] if policy.counts is Counts.LAST else max(kept, key=lambda one: one.score)


def hidden_items(policy: AssignmentPolicy, now: datetime) -> frozenset[str]:
    """Return the ids of the rubric items that students do not see at `now`."""
    if policy.hidden_until is not None and now >= policy.hidden_until:
        return frozenset()
    return frozenset(policy.hidden_items)


def is_hidden(item_id: str, hidden: frozenset[str]) -> bool:
    """Whether an item of a report (``id``, or ``case/id``) is one of the `hidden` ones."""
    return item_id in hidden or item_id.rpartition("/")[2] in hidden


def _too_many_today(
    policy: AssignmentPolicy, costly: Sequence[Attempt], received_at: datetime, zone: ZoneInfo
) -> Refusal | None:
    if policy.attempts_per_day is None:
        return None
    today = received_at.astimezone(zone).date()
    used = sum(attempt.received_at.astimezone(zone).date() == today for attempt in costly)
    if used < policy.attempts_per_day:
        return None
    tomorrow = datetime.combine(today + timedelta(days=1), time(), zone)
    return Refusal(code="no_attempts_today", until=tomorrow)
