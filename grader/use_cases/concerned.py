"""The students behind a number of the dashboard: who failed an item, made a mistake, or has a status."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import StudentProgress
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Member, Role
from grader.contracts.report import GradeStatus
from grader.contracts.submission import SubmissionState
from grader.contracts.text import Text
from grader.messages import template
from grader.store.dashboard import CountedCell
from grader.use_cases.assignments import published
from grader.use_cases.callers import require_staff
from grader.use_cases.people import members
from grader.use_cases.services import Services


@dataclass(frozen=True, slots=True, kw_only=True)
class Concern:
    """What students are asked for; None: it does not matter.

    Attributes:
        item: they failed it in at least one submission. mistake: they made it in one, by its code.
        status: the state or the verdict of their latest submission.
    """

    item: str | None = None
    mistake: str | None = None
    status: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Concerned:
    """A student to whom a concern applies. `still`: their best submission fails the item, too."""

    student: str
    name: str
    sections: tuple[str, ...]
    progress: StudentProgress
    still: bool


def concerned(
    services: Services, caller: Caller, assignment_id: str, concern: Concern
) -> tuple[Concerned, ...]:
    """Return the students to whom a concern applies: first those who still fail, then those who tried most.

    Raises:
        RefusedError: the caller may not see the class; or there is no such assignment, item of it, mistake or
            status.
    """
    require_staff(caller)
    cells = services.dashboard.cells(caller.course)
    own = {student: cell for (student, assignment), cell in cells.items() if assignment == assignment_id}
    assignment = published(services, caller, assignment_id)
    if not own and assignment is None:
        raise RefusedError("assignment_not_found")
    if concern.item is not None:
        _check_item(concern.item, assignment, own.values())
    _check_codes(concern, own.values())
    roster = {member.id: member for member in members(services, caller, Role.STUDENT)}
    fits = _fits(concern)
    students = [
        _concerned(roster.get(student), cell, concern)
        for student, cell in own.items()
        if caller.looks_after(student) and fits(cell)
    ]
    return tuple(
        sorted(students, key=lambda student: (not student.still, -student.progress.attempts, student.student))
    )


def _check_item(item: str, assignment: Assignment | None, cells: Iterable[CountedCell]) -> None:
    ids = [] if assignment is None else [rubric_item.id for rubric_item in assignment.items]
    failed = {one for cell in cells for one in cell.failed}  # also by an earlier version of it
    if item not in failed and item.rpartition("/")[2] not in ids:
        detail = Text(zh="没有这个评分项。", en="There is no such item.")
        raise RefusedError("invalid_request", detail, field="item", allowed=ids)


def _check_codes(concern: Concern, cells: Iterable[CountedCell]) -> None:
    statuses = [state.value for state in (*SubmissionState, *GradeStatus)]
    recognised = {one for cell in cells for one in cell.mistakes}  # also what an earlier version recognised
    mistake = concern.mistake
    if mistake is not None and mistake not in recognised and template("en", f"mistake.{mistake}") is None:
        detail = Text(zh="没有这种错误。", en="There is no such mistake.")
        raise RefusedError("invalid_request", detail, field="mistake")
    if concern.status is not None and concern.status not in statuses:
        detail = Text(zh="没有这种状态。", en="There is no such status.")
        raise RefusedError("invalid_request", detail, field="status", allowed=sorted(set(statuses)))


def _fits(concern: Concern) -> Callable[[CountedCell], bool]:
    def fits(cell: CountedCell) -> bool:
        standing = (cell.progress.state.value, cell.progress.verdict and cell.progress.verdict.value)
        return (
            (concern.item is None or concern.item in cell.failed)
            and (concern.mistake is None or concern.mistake in cell.mistakes)
            and (concern.status is None or concern.status in standing)
        )

    return fits


def _concerned(member: Member | None, cell: CountedCell, concern: Concern) -> Concerned:
    return Concerned(
        student=cell.progress.student,
        name="" if member is None else member.name,
        sections=() if member is None else member.sections,
        progress=cell.progress,
        still=concern.item is not None and concern.item in cell.still,
    )
