"""Grading again: first on trial, with what would change, then applied with a reason or discarded.

An applied re-grade can be undone as a whole. Students see what either did to their points.
"""

from dataclasses import replace
from typing import Literal

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Role
from grader.contracts.own_assignment import OwnState
from grader.contracts.regrade import PastGrading, Regrade, ToldChange, Wanted
from grader.contracts.rules import is_hidden
from grader.contracts.submission import StoredReport, Submission
from grader.contracts.text import Text
from grader.use_cases.assignments import require_published
from grader.use_cases.callers import require_instructor, require_staff
from grader.use_cases.people import names
from grader.use_cases.services import Services
from grader.use_cases.visibility import found, visible_submission

_EXAMINED = Text(
    zh="这个作业的新版本正在检查，重评要用它：等它通过再开始。",
    en="A new version of it is being examined, and a re-grade would use the one before: wait until it has passed.",
)
Ending = Literal["apply", "discard", "undo"]


def open_regrade(services: Services, caller: Caller, wanted: Wanted) -> Regrade:
    """Start a re-grade and tell workers that there is work.

    Raises:
        RefusedError: the caller is no instructor, the assignment is not published or a new version of it is being
            examined, a student is unknown, nothing is to be graded, or a re-grade of it is open.
    """
    require_instructor(caller)
    require_published(services, caller, wanted.assignment, field="assignment")
    uploads = () if caller.course is None else services.own_assignments.of(caller.course)
    if any(upload.assignment == wanted.assignment and upload.state is OwnState.WAITING for upload in uploads):
        raise RefusedError("invalid_request", _EXAMINED, field="assignment")
    roster = names(services, caller)
    if unknown := [student for student in wanted.students if roster and student not in roster]:
        listed = ", ".join(unknown[:10])
        detail = Text(zh=f"没有这些学号：{listed}", en=f"No student has these ids: {listed}")
        raise RefusedError("unknown_student", detail, field="students")
    regrade = services.regrades.open(wanted, services.signature(caller))
    services.doorbell.ring()
    return regrade


def all_regrades(services: Services, caller: Caller) -> tuple[Regrade, ...]:
    """Return the caller's course's re-grades, newest first, without those of other assistants' students only.

    For staff.
    """
    require_staff(caller)
    regrades = services.regrades.all(caller.course)
    return tuple(_of_caller(caller, regrade) for regrade in regrades if _concerns(caller, regrade))


def regrade_of(services: Services, caller: Caller, regrade_id: str) -> Regrade:
    """Return a re-grade of the caller's course.

    Raises RefusedError: no re-grade that the caller may see has that id, or the caller may not see the class.
    """
    require_staff(caller)
    regrade = services.regrades.get(regrade_id, caller.course)
    if regrade is None or not _concerns(caller, regrade):
        raise RefusedError("regrade_not_found")
    return _of_caller(caller, regrade)


def _concerns(caller: Caller, regrade: Regrade) -> bool:
    """Whether a re-grade is of everybody, or of a student whom the caller looks after."""
    named = regrade.wanted.students
    return not named or any(caller.looks_after(name) for name in named)


def _of_caller(caller: Caller, regrade: Regrade) -> Regrade:
    """Return a re-grade with the changes of students that the caller looks after."""
    if caller.students is None:
        return regrade
    changes = tuple(change for change in regrade.changes if caller.looks_after(change.student))
    students = tuple(student for student in regrade.wanted.students if caller.looks_after(student))
    return replace(regrade, changes=changes, wanted=replace(regrade.wanted, students=students))


def both_gradings(
    services: Services, caller: Caller, regrade_id: str, submission_id: str
) -> tuple[Regrade, Submission, StoredReport, StoredReport]:
    """Return a re-grade, a submission, and its gradings before it and by it.

    Raises RefusedError: there is no such re-grade or submission, or not both gradings.
    """
    regrade = regrade_of(services, caller, regrade_id)
    submission, _ = found(services, caller, submission_id)
    before, after = services.submissions.around_regrade(regrade.id, submission.id)
    if before is None or after is None:
        raise RefusedError("not_graded_yet")
    return regrade, submission, before, after


def history(services: Services, caller: Caller, submission_id: str) -> tuple[PastGrading, ...]:
    """Return every grading of a submission, oldest first; one of them stands.

    Raises RefusedError: the caller may not see the class, or there is no such submission.
    """
    require_staff(caller)
    visible_submission(services, caller, submission_id)
    return tuple(services.regrades.history(submission_id))


def past_grading(services: Services, caller: Caller, submission_id: str, attempt: int) -> StoredReport:
    """Return one grading of a submission by its number.

    Raises as `history`, or there is no grading of that number.
    """
    require_staff(caller)
    visible_submission(services, caller, submission_id)
    stored = services.submissions.grading(submission_id, attempt)
    if stored is None:
        raise RefusedError("submission_not_found")
    return stored


def decide(services: Services, caller: Caller, regrade_id: str, ending: Ending, reason: str) -> Regrade:
    """Apply or discard a re-grade, or undo one that was applied.

    Raises:
        RefusedError: the caller is no instructor; the re-grade does not exist, is decided, or still runs; or, to
            be undone, was not applied, or a later one stands on it.
    """
    require_instructor(caller)
    ends = {
        "apply": services.regrades.apply,
        "discard": services.regrades.discard,
        "undo": services.regrades.undo,
    }
    return ends[ending](regrade_id, services.signature(caller), reason)


def told_changes(services: Services, caller: Caller, submission_id: str) -> tuple[ToldChange, ...]:
    """Return what re-grades changed of a submission, the latest first; a student sees no hidden items in it.

    Raises RefusedError: the caller may not see it.
    """
    return _shown_changes(services, caller, visible_submission(services, caller, submission_id))


def look_at_changes(services: Services, caller: Caller, submission: Submission) -> tuple[ToldChange, ...]:
    """Return what `told_changes` does, and note that the submission's student has seen it."""
    changes = _shown_changes(services, caller, submission)
    if caller.role is Role.STUDENT and any(not change.seen for change in changes):
        services.regrades.mark_seen(submission.id, services.clock())
    return changes


def unseen_changes(services: Services, caller: Caller) -> tuple[str, ...]:
    """Return the caller's submissions that re-grades changed and the caller has not looked at since."""
    if caller.course is None or caller.person is None or caller.role is not Role.STUDENT:
        return ()
    changes = services.regrades.unseen(caller.course, caller.person)
    if not changes:
        return ()
    rules, now = services.rules.of(caller.course), services.clock()
    shown = (_without(change, rules.of(change.assignment).hidden_at(now)) for change in changes)
    return tuple(dict.fromkeys(change.submission for change in shown if change is not None))


def _shown_changes(services: Services, caller: Caller, submission: Submission) -> tuple[ToldChange, ...]:
    changes = services.regrades.changes_of(submission.id)
    if not changes or caller.role is not Role.STUDENT:
        return changes
    hidden = services.rules.of(submission.course).of(submission.assignment).hidden_at(services.clock())
    shown = (_without(change, hidden) for change in changes)
    return tuple(change for change in shown if change is not None)


def _without(whole: ToldChange, hidden: frozenset[str]) -> ToldChange | None:
    """Return a change without hidden items, and without scores, which reveal them; None if nothing is left."""
    if not hidden:
        return whole
    change = whole.change
    items = tuple(item for item in change.items if not is_hidden(item.item, hidden))
    kept, void = (
        tuple(name for name in named if not is_hidden(name, hidden)) for named in (change.kept, change.void)
    )
    shown = replace(change, before=None, after=None, items=items, kept=kept, void=void)
    return replace(whole, change=shown) if items else None
