"""What a caller may see: whose submissions, and which rubric items.

Rules can hide rubric items from students, until a date or for ever. A student's copy of a report lacks the hidden
items and every sentence that might give them away, such as the summary. Its score and points are sums over the
items that are left, and it has its own digest.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from grader.contracts.assignment import Assignment, Hints
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Role
from grader.contracts.judgement import judged
from grader.contracts.record import canonical, to_plain
from grader.contracts.report import GradeReport, GradeStatus, report_from
from grader.contracts.rubric import ItemStatus, summed, to_judge
from grader.contracts.rules import HintRule, is_hidden
from grader.contracts.submission import StoredReport, Submission
from grader.contracts.text import EMPTY, LANGUAGES, Text
from grader.operation.logs import note
from grader.store.rules import CourseRules
from grader.use_cases.services import Services

_RETRY_AFTER_S = 5
_EMPTY = {"zh": "", "en": ""}


@dataclass(frozen=True, slots=True, kw_only=True)
class Hiding:
    """The items of an assignment that are hidden from students now, and until when; None: for ever."""

    items: frozenset[str]
    until: datetime | None


@dataclass(frozen=True, slots=True)
class _Veil:
    """What a caller does not see: hidden items, and hints that are not `own_hints` (None: all are told)."""

    hidden: frozenset[str] = frozenset()
    own_hints: Mapping[str, Mapping[str, str]] | None = None


def hiding(services: Services, submission: Submission) -> Hiding:
    """Return the items of a submission that are hidden from students now. Only staff may be shown the answer."""
    rules = services.rules.of(submission.course).of(submission.assignment)
    return Hiding(items=rules.hidden_at(services.clock()), until=rules.hidden_until)


def visible_submission(services: Services, caller: Caller, submission_id: str) -> Submission:
    """Return a submission without its grading. Its score still includes hidden items.

    Raises RefusedError: no submission has that id, or it is somebody else's; the refusal is the same.
    """
    return _require_visible(caller, services.submissions.get(submission_id))


def found(services: Services, caller: Caller, submission_id: str) -> tuple[Submission, StoredReport | None]:
    """Return a submission and its latest grading, None before the first, as the caller may see them.

    Raises RefusedError: no submission has that id, or it is somebody else's; the refusal is the same.
    """
    submission, report, _ = found_by_rules(services, caller, submission_id)
    return submission, report


def found_by_rules(
    services: Services, caller: Caller, submission_id: str
) -> tuple[Submission, StoredReport | None, CourseRules]:
    """Return what `found` does, and the rules that concern the submission. Raises as `found`."""
    submission, report = services.submissions.with_report(submission_id) or (None, None)
    submission = _require_visible(caller, submission)
    rules = services.rules.about(submission.course, submission.student, submission.assignment)
    veil = _veil(services, caller, submission.assignment, rules)
    return *_shown(submission, report, veil), rules


def graded(services: Services, caller: Caller, submission_id: str) -> tuple[Submission, StoredReport]:
    """Return a submission and its latest grading, as the caller may see them.

    Raises as `found`, or there is no grading yet.
    """
    submission, report = found(services, caller, submission_id)
    if report is None:
        state = submission.state.value
        detail = Text(zh=f"提交的状态是 {state}。", en=f"The submission is {state}.")
        raise RefusedError("not_graded_yet", detail, retry_after_s=_RETRY_AFTER_S)
    return submission, report


def _require_visible(caller: Caller, submission: Submission | None) -> Submission:
    if submission is None or not caller.may_see(submission.course, submission.student):
        raise RefusedError("submission_not_found")
    note(submission=submission.id, assignment=submission.assignment)
    return submission


def shown_assignment(services: Services, caller: Caller, assignment: Assignment) -> Assignment:
    """Return an assignment as the course grades it, without the items that the caller does not see now."""
    return shown_assignments(services, caller, (assignment,))[0]


def shown_assignments(
    services: Services, caller: Caller, assignments: Sequence[Assignment]
) -> tuple[Assignment, ...]:
    """Return assignments as the course grades them, without the items that the caller does not see now."""
    if caller.course is None:
        return tuple(assignments)
    rules, now = services.rules.of(caller.course), services.clock()
    hides = caller.role is Role.STUDENT
    return tuple(
        _without_items(
            assignment.of_course(rules.distro, rules.runs_as),
            rules.of(assignment.id).hidden_at(now) if hides else frozenset(),
        )
        for assignment in assignments
    )


def hint_level(services: Services, caller: Caller, assignment_id: str, rules: CourseRules) -> Hints:
    """Return how much the caller is told of lost points. Staff is told everything."""
    if caller.is_staff:
        return Hints.CHANGE
    rule = rules.of(assignment_id).hints
    if rule is not HintRule.ASSIGNMENT:
        return Hints(rule.value)
    assignments = services.assignments.of(caller.course).all()
    return next(
        (assignment.hints for assignment in assignments if assignment.id == assignment_id), Hints.CHANGE
    )


def _veil(services: Services, caller: Caller, assignment_id: str, rules: CourseRules) -> _Veil:
    hides = caller.course is not None and caller.role is Role.STUDENT
    hidden = rules.of(assignment_id).hidden_at(services.clock()) if hides else frozenset[str]()
    if hint_level(services, caller, assignment_id, rules) is Hints.CHANGE:
        return _Veil(hidden)
    items = services.assignments.of(caller.course).get(assignment_id).items
    return _Veil(hidden, {item.id: to_plain(item.hint) for item in items if item.hint != EMPTY})


def _shown(
    submission: Submission, stored: StoredReport | None, veil: _Veil
) -> tuple[Submission, StoredReport | None]:
    hidden = veil.hidden
    if veil == _Veil() or stored is None:
        return submission, stored
    report = _veiled(json.loads(stored.content), veil)
    content = canonical(report)
    digest = hashlib.sha256(content).hexdigest()
    shown = replace(submission, score=report["score"], max_score=report["max_score"], report_sha256=digest)
    copy = replace(
        stored,
        content=content,
        sha256=digest,
        judgements=tuple(
            judgement for judgement in stored.judgements if not is_hidden(judgement.item, hidden)
        ),
    )
    if submission.to_judge is None and not copy.judgements:
        return shown, copy
    whole = judged(copy)
    waiting = None if submission.to_judge is None else to_judge(whole.items)
    return replace(shown, score=whole.score, verdict=whole.status, to_judge=waiting), copy


def shown_report(services: Services, caller: Caller, report: GradeReport) -> GradeReport:
    """Return a report that is not stored, without what would be hidden from the caller if it were."""
    veil = _veils(services, caller, report.assignment)[report.assignment]
    if veil == _Veil():
        return report
    return report_from(json.dumps(_veiled(json.loads(report.canonical_bytes()), veil)))


def shown_list(
    services: Services, caller: Caller, submissions: Iterable[Submission]
) -> tuple[Submission, ...]:
    """Return submissions as the caller may see them: scores without hidden items."""
    listed = tuple(submissions)
    veils = _veils(services, caller, *{submission.assignment for submission in listed})
    return tuple(_listed(services, submission, veils[submission.assignment]) for submission in listed)


def _listed(services: Services, submission: Submission, veil: _Veil) -> Submission:
    if veil == _Veil() or submission.report_sha256 is None:
        return submission
    return _shown(submission, services.submissions.report(submission.id), veil)[0]


def _veils(services: Services, caller: Caller, *assignments: str) -> dict[str, _Veil]:
    """Return what the caller does not see of each assignment; the rules are read once for all."""
    if caller.is_staff:
        return dict.fromkeys(assignments, _Veil())
    rules = services.rules.of(caller.course)
    return {assignment: _veil(services, caller, assignment, rules) for assignment in assignments}


def _without_items(assignment: Assignment, hidden: frozenset[str]) -> Assignment:
    if not hidden:
        return assignment
    items = tuple(
        replace(
            item,
            needs=tuple(needed for needed in item.needs if needed not in hidden),
            scaled_by=tuple(scaling for scaling in item.scaled_by if scaling not in hidden),
        )
        for item in assignment.items
        if item.id not in hidden
    )
    return replace(assignment, items=items)


def _veiled(report: dict[str, Any], veil: _Veil) -> dict[str, Any]:
    """Return a report without what is hidden, and with the teacher's own hints alone if others are not told."""
    shown = _without(report, veil.hidden) if veil.hidden else report
    own = veil.own_hints
    if own is None:
        return shown
    items = [
        {**item, "hint": _EMPTY if item["hint"] == _EMPTY else own.get(item["id"].rpartition("/")[2], _EMPTY)}
        for item in shown["items"]
    ]
    first = next((item["hint"] for item in items if item["hint"] != _EMPTY), _EMPTY)
    return {**shown, "items": items, "hint": first, "mistakes": []}


def _without(report: dict[str, Any], hidden: frozenset[str]) -> dict[str, Any]:
    titles = [item["title"] for item in report["items"] if is_hidden(item["id"], hidden)]
    items = [_silent(item, titles) for item in report["items"] if not is_hidden(item["id"], hidden)]
    waits = _waits(items)
    unknown = waits or (report["score"] is None and not _waits(report["items"]))
    earned = None if unknown else summed(item["earned"] for item in items)
    points = summed(item["points"] for item in items)
    about_the_whole: dict[str, Any] = {"summary": _EMPTY, "hint": _EMPTY, "mistakes": []}
    if not unknown and report["status"] == GradeStatus.NEEDS_MANUAL.value:
        about_the_whole["status"] = GradeStatus.GRADED.value  # no item that is shown waits for a person
    return {**report, **about_the_whole, "items": items, "score": earned, "max_score": points}


def _silent(item: dict[str, Any], titles: Iterable[Mapping[str, str]]) -> dict[str, Any]:
    """Return an item without its message if the message names a hidden item."""
    named = any(title[language] in item["message"][language] for title in titles for language in LANGUAGES)
    return {**item, "message": _EMPTY} if named and item["status"] != ItemStatus.PASSED.value else item


def _waits(items: Iterable[Mapping[str, Any]]) -> bool:
    return any(item["status"] == ItemStatus.NEEDS_MANUAL.value for item in items)
