"""Appeals: a student asks for another look at a rubric item, staff answer, correct the points, or refuse.

An appeal belongs to one submission. Grading that again and handing in another one leave it open: staff see what
the item has now. Whatever points a person gives for its item answer it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from grader.contracts.appeal import ANSWERS, LONGEST_TEXT, Appeal, AppealState
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Role, Seen
from grader.contracts.judgement import judged
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.rules import is_hidden
from grader.contracts.submission import StoredReport, Submission
from grader.contracts.text import Text
from grader.store.appeals import AppealsWanted, Asked
from grader.use_cases import judging
from grader.use_cases.assignments import require_published
from grader.use_cases.callers import require_staff
from grader.use_cases.commenting import checked_text
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded, visible_submission

_TEXT = Text(
    zh=f"要写 1 到 {LONGEST_TEXT} 个字符，不能有控制字符。",
    en=f"Write 1 to {LONGEST_TEXT} characters and no control characters.",
)
_WAITS = Text(zh="这一项还没有评分。", en="The item has not been judged yet.")
_FULL = Text(zh="这一项已经是满分。", en="The item has all its points.")
_POINTS = Text(
    zh="改分（corrected）要给 points，其他答复不改分。",
    en="A correction (`corrected`) takes points; other answers change none.",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class AppealAnswer:
    """What staff say to an appeal. `points`: those that the item gets, when it is corrected, else None."""

    state: AppealState
    text: str
    points: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class AppealPage:
    """Some of a class's appeals; `total`: of all pages. `waiting`: all that are open, whatever was asked for."""

    appeals: Sequence[Appeal]
    total: int
    waiting: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Pending:
    """The appeals that a student is reminded of: those that wait, and those whose answer is new."""

    open: Sequence[Appeal]
    answered: Sequence[Appeal]


def ask(services: Services, caller: Caller, submission_id: str, item: str, reason: str) -> Appeal:
    """Keep the caller's appeal about an item of their own submission.

    Raises:
        RefusedError: the caller may not see the submission or is no student of a course; it has no grading; there
            is no such item, it waits for a person or has all points; the rules take no appeals now; the reason is
            missing; or the caller has asked before.
    """
    submission, stored = graded(services, caller, submission_id)
    if caller.course is None:
        raise RefusedError("no_course")
    if caller.role is not Role.STUDENT:
        raise RefusedError("forbidden")
    if not services.rules.of(caller.course).of(submission.assignment).may_appeal_at(services.clock()):
        raise RefusedError("appeals_closed")
    items = judged(stored).items
    measured = next((rubric_item for rubric_item in items if rubric_item.id == item), None)
    if measured is None:
        raise RefusedError("item_not_found", field="item", allowed=[rubric_item.id for rubric_item in items])
    if not _can_gain(measured):
        waits = measured.status is ItemStatus.NEEDS_MANUAL
        raise RefusedError("invalid_request", _WAITS if waits else _FULL, field="item")
    asked = Asked(
        item=item,
        reason=checked_text(reason, LONGEST_TEXT, _TEXT, "reason"),
        attempt=stored.attempt,
        earned=measured.earned,
        points=measured.points,
    )
    return services.appeals.ask(submission.id, asked, services.signature(caller))


def take_back(services: Services, caller: Caller, submission_id: str, item: str) -> None:
    """Withdraw the caller's open appeal; the student may ask again while the rules take appeals.

    Raises RefusedError: the caller may not see the submission or is no student; there is no open appeal.
    """
    submission = visible_submission(services, caller, submission_id)
    if caller.role is not Role.STUDENT:
        raise RefusedError("forbidden" if caller.role is not None else "appeal_not_found")
    services.appeals.withdraw(submission.id, item, services.signature(caller))


def appeals_of(services: Services, caller: Caller, submission_id: str) -> tuple[Appeal, ...]:
    """Return the appeals about a submission; a student sees none about items that are hidden now.

    Raises RefusedError: the caller may not see it.
    """
    return _shown(services, caller, visible_submission(services, caller, submission_id))


def look(services: Services, caller: Caller, submission: Submission) -> dict[str, Appeal]:
    """Return the appeals about a submission by item, and note that its student has seen the answers."""
    appeals = _shown(services, caller, submission)
    news = [appeal.item for appeal in appeals if appeal.state in ANSWERS and not appeal.seen]
    if news and caller.role is Role.STUDENT:
        services.appeals.mark_seen(submission.id, news, services.clock())
    return {appeal.item: appeal for appeal in appeals}


def open_to(
    services: Services,
    caller: Caller,
    submission: Submission,
    stored: StoredReport | None,
    appeals: Mapping[str, Appeal],
) -> frozenset[str]:
    """Return the items about which the caller may ask now; `appeals` are those that there are, by item."""
    if caller.course is None or caller.role is not Role.STUDENT or stored is None:
        return frozenset()
    rules = services.rules.of(caller.course)
    if rules.archived or not rules.of(submission.assignment).may_appeal_at(services.clock()):
        return frozenset()
    asked = {item for item, one in appeals.items() if one.state is not AppealState.WITHDRAWN}
    return frozenset(item.id for item in judged(stored).items if _can_gain(item) and item.id not in asked)


def pending(services: Services, caller: Caller) -> Pending | None:
    """Return the appeals that a student of a course is reminded of; None when there are none."""
    if caller.course is None or caller.person is None or caller.role is not Role.STUDENT:
        return None
    appeals = services.appeals.of_student(caller.course, caller.person)
    if not appeals:
        return None
    rules, now = services.rules.of(caller.course), services.clock()
    shown = [
        appeal for appeal in appeals if not is_hidden(appeal.item, rules.of(appeal.assignment).hidden_at(now))
    ]
    appeal_page = Pending(
        open=[appeal for appeal in shown if appeal.is_open],
        answered=[appeal for appeal in shown if not appeal.is_open],
    )
    return appeal_page if shown else None


def queue(
    services: Services, caller: Caller, wanted: AppealsWanted, *, offset: int, limit: int
) -> AppealPage:
    """Return at most `limit` appeals of the caller's class. For staff.

    Raises RefusedError: the caller may not see the class; or nothing fits, and there is no such assignment.
    """
    require_staff(caller)
    wanted = replace(wanted, students=caller.students)
    total = services.appeals.count(caller.course, wanted)
    if wanted.assignment is not None and not total:
        require_published(services, caller, wanted.assignment, "unknown_assignment", field="assignment")
    return AppealPage(
        appeals=services.appeals.listed(caller.course, wanted, offset, limit),
        total=total,
        waiting=waiting(services, caller),
    )


def waiting(services: Services, caller: Caller) -> int:
    """Return how many appeals of the caller's class wait for an answer. For staff."""
    require_staff(caller)
    return services.appeals.count(caller.course, AppealsWanted(students=caller.students))


def answer(  # noqa: PLR0913
    services: Services,
    caller: Caller,
    submission_id: str,
    item: str,
    given: AppealAnswer,
    *,
    seen: Seen | None,
) -> None:
    """Answer an open appeal in words, by other points, or by refusing it.

    Points are given as `judging.give` does it, of an item in one of the states `seen`.

    Raises:
        RefusedError: the caller may not see the class or the submission; there is no open appeal; words or points
            are missing; or as `judging.give`.
    """
    require_staff(caller)
    submission = visible_submission(services, caller, submission_id)
    text = checked_text(given.text, LONGEST_TEXT, _TEXT)
    if given.state not in ANSWERS or (given.points is not None) is not (given.state is AppealState.CORRECTED):
        raise RefusedError("invalid_request", _POINTS, field="points")
    appeals = {appeal.item: appeal for appeal in services.appeals.of(submission.id)}
    if item not in appeals:
        raise RefusedError("appeal_not_found")
    if not appeals[item].is_open:
        raise RefusedError("appeal_decided")
    if given.points is not None:
        judging.give(
            services, caller, submission.id, item, points=given.points, comment=text, seen=seen, answers=True
        )
        return
    services.appeals.answer(submission.id, item, given.state, text, services.signature(caller))


def pass_on(services: Services, caller: Caller, submission_id: str, item: str, note: str) -> None:
    """Leave an open appeal to the instructors, with what they should know; the student is told nothing of it.

    Raises:
        RefusedError: the caller may not see the class or the submission; there is no open appeal; or the note is
            missing.
    """
    require_staff(caller)
    submission = visible_submission(services, caller, submission_id)
    note = checked_text(note, LONGEST_TEXT, _TEXT)
    services.appeals.pass_on(submission.id, item, note, services.signature(caller))


def _shown(services: Services, caller: Caller, submission: Submission) -> tuple[Appeal, ...]:
    appeals = services.appeals.of(submission.id)
    if not appeals or caller.is_staff:
        return appeals
    hidden = services.rules.of(submission.course).of(submission.assignment).hidden_at(services.clock())
    return tuple(appeal for appeal in appeals if not is_hidden(appeal.item, hidden))


def _can_gain(item: RubricItem) -> bool:
    return item.status is not ItemStatus.NEEDS_MANUAL and item.earned < item.points
