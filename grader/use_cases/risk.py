"""Who may need help: who tries and fails, whose due date is near or over, who has not begun."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import Literal, get_args

from grader.contracts.dashboard import StudentProgress
from grader.contracts.identity import Member
from grader.contracts.python import UTC
from grader.contracts.submission import RefusedUpload
from grader.store.rules import CourseRules

STUCK_ATTEMPTS = 3
_CRASHES = 2
_SOON = timedelta(days=3)
_NEVER = datetime.max.replace(tzinfo=UTC)
Reason = Literal["refused", "crashed", "stuck", "due_soon", "overdue", "not_started"]
REASONS: tuple[Reason, ...] = get_args(Reason)
_TROUBLE: frozenset[Reason] = frozenset({"refused", "crashed", "stuck"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell(StudentProgress):
    """One student at one assignment, and whether what counts is a pass."""

    passed: bool

    @property
    def stuck(self) -> bool:
        """Whether the student tried often and has not passed."""
        return not self.passed and not self.waits_for_person and self.attempts >= STUCK_ATTEMPTS


@dataclass(frozen=True, slots=True, kw_only=True)
class Risk:
    """Why a student may need help.

    Attributes:
        reason: ``refused``: uploads were refused and none was accepted since; ``crashed``: the latest two attempts
            or more did not run to their end; ``stuck``: three attempts or more without passing; ``due_soon``,
            ``overdue``: nothing handed in, or nothing that passes; ``not_started``: nothing in the whole course.
        attempts: those that count, or of ``refused`` how many uploads. due: the student's own due date.
    """

    student: str
    reason: Reason
    name: str = ""
    assignment: str | None = None
    attempts: int = 0
    due: datetime | None = None

    @property
    def urgency(self) -> tuple[bool, bool, int, datetime, int, str]:
        """Order of help: trouble first, and in it what is due next; then what is due soon, overdue, not begun."""
        trouble = self.reason in _TROUBLE
        rank = 0 if trouble else REASONS.index(self.reason)
        return (not trouble, self.due is None, rank, self.due or _NEVER, -self.attempts, self.student)


def risks(  # noqa: PLR0913, PLR0917
    cells: Mapping[str, Mapping[str, Cell]],
    roster: Mapping[str, Member],
    refused: Iterable[RefusedUpload],
    rules: CourseRules,
    assignments: Iterable[str],
    now: datetime,
) -> list[Risk]:
    """Return the students who may need help, each once, for the most urgent reason, the most urgent first.

    `cells` by student and assignment; `assignments`: those that students see.
    """
    refusals = _since_accepted(cells, refused)
    dated = {
        assignment
        for assignment in assignments
        if rules.of(assignment).due is not None or rules.of(assignment).by_section
    }
    urgent = []
    for student in {**roster, **cells}:
        own, tries = cells.get(student, {}), refusals.get(student, Counter())
        concerned = own.keys() | tries.keys() | (dated if student in roster else set())
        each = (
            _risk(student, assignment, own.get(assignment), tries[assignment], rules, now)
            for assignment in concerned
        )
        at_risk = [risk for risk in each if risk is not None]
        if at_risk:
            urgent.append(min(at_risk, key=lambda one: one.urgency))
        elif not own:
            urgent.append(Risk(student=student, reason="not_started"))
    named = (
        replace(risk, name=roster[risk.student].name) if risk.student in roster else risk for risk in urgent
    )
    return sorted(named, key=lambda one: one.urgency)


def _risk(  # noqa: PLR0913, PLR0917
    student: str, assignment: str, cell: Cell | None, refusals: int, rules: CourseRules, now: datetime
) -> Risk | None:
    if cell is not None and (cell.passed or cell.waits_for_person):
        return None  # before the due dates are looked up: so it is with most cells of a class
    due = rules.of(assignment, student).due_for(rules.extension(assignment, student))
    reason = _reason(cell, refusals, due, now)
    if reason is None:
        return None
    attempts = refusals if reason == "refused" else 0 if cell is None else cell.attempts
    return Risk(student=student, reason=reason, assignment=assignment, attempts=attempts, due=due)


def mark_of(refused: Sequence[RefusedUpload], rules: CourseRules, now: datetime) -> tuple[object, ...]:
    """Return what changes whenever `risks` does and what was handed in does not: refusals, and dates that pass."""
    dues = [rule.due for rule in rules.by_assignment.values()]
    dues += [section_rule.due for rule in rules.by_assignment.values() for section_rule in rule.by_section]
    dues += [extension.due for extension in rules.extensions.values()]
    passed = [(due <= now) + (due - _SOON <= now) for due in dues if due is not None]
    return len(refused), refused[:1], sum(passed)


def _since_accepted(
    cells: Mapping[str, Mapping[str, Cell]], refused: Iterable[RefusedUpload]
) -> dict[str, Counter[str]]:
    """Return how many uploads were refused since the latest that was accepted, by student and assignment."""
    counts: dict[str, Counter[str]] = {}
    for refusal in refused:
        cell = cells.get(refusal.person, {}).get(refusal.assignment)
        if cell is None or refusal.at > cell.last_activity_at:
            counts.setdefault(refusal.person, Counter())[refusal.assignment] += 1
    return counts


def _reason(cell: Cell | None, refusals: int, due: datetime | None, now: datetime) -> Reason | None:
    if refusals:
        return "refused"
    if cell is not None and cell.crashes >= _CRASHES:
        return "crashed"
    if cell is not None and cell.stuck:
        return "stuck"
    if due is not None and due <= now:
        return "overdue"
    return "due_soon" if cell is None and due is not None and due - now <= _SOON else None
