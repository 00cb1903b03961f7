"""The class matrix as its page shows it: searched, filtered, sorted, one page of it. Pure functions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal, get_args

from pydantic import Field

from grader.contracts.identity import Member
from grader.contracts.python import UTC
from grader.contracts.submission import SubmissionState
from grader.service.web.paging import PageQuery, cut
from grader.use_cases.dashboard import AssignmentOverview, Overview, StudentLine
from grader.use_cases.risk import Cell, Risk

Show = Literal["all", "at_risk", "unfinished", "not_begun", "stuck", "waiting", "judge", "fault"]
SHOWS: tuple[Show, ...] = get_args(Show)
_NEVER = datetime.min.replace(tzinfo=UTC)
_WAITING = (SubmissionState.QUEUED, SubmissionState.RUNNING)


class MatrixQuery(PageQuery):
    """What the instructor asked for.

    Attributes:
        search: part of a student's id or name. show: which students (``at_risk``: may need help, the
            most urgent first); assignment: judge that by this assignment only.
        section: only its students.
        sort: ``student``, ``section``, ``total``, ``activity`` or the id of an assignment.
    """

    search: str = Field(default="", max_length=100)
    show: Show = "all"
    assignment: str = Field(default="", max_length=64)
    section: str = Field(default="", max_length=64)
    sort: str = Field(default="student", max_length=64)
    descending: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnCell:
    """One student at one assignment. `look`: full, passed, low, waiting, fault or none."""

    assignment: str
    look: str
    cell: Cell | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One student, cells in the order of the assignments. `name` may be empty; `risk`: why they may need help."""

    student: StudentLine
    name: str
    cells: tuple[DrawnCell, ...]
    risk: Risk | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Matrix:
    """One page of the matrix. `found` of `all` students fit the query."""

    assignments: Sequence[AssignmentOverview]
    rows: tuple[Row, ...]
    found: int
    all: int
    pages: int
    query: MatrixQuery


def matrix(dashboard: Overview, query: MatrixQuery, members: Sequence[Member]) -> Matrix:
    """Return the page of the class that `query` asks for; beyond the last page, the last.

    `members` are the students on the roster: who handed in nothing has a row, too.
    """
    ids = [assignment.id for assignment in dashboard.assignments]
    judged = [query.assignment] if query.assignment in ids else ids
    wanted = query.search.strip().lower()
    everybody = _everybody(dashboard, members)
    students = [
        student
        for student in everybody
        if (wanted in student.student.lower() or wanted in student.name.lower())
        and (not query.section or query.section in student.sections)
        and (query.show == "at_risk" or _fits(student, judged, query.show))
    ]
    students.sort(key=_sort_key(query.sort), reverse=query.descending)
    risks = {risk.student: risk for risk in dashboard.at_risk if query.show == "at_risk"}
    if query.show == "at_risk":
        students = [student for student in students if _at_risk_in(risks.get(student.student), judged)]
        if query.sort == "student":
            students.sort(key=lambda one: risks[one.student].urgency)
    shown, query, pages = cut(students, query)
    return Matrix(
        assignments=dashboard.assignments,
        rows=tuple(_row(student, ids, risks.get(student.student)) for student in shown),
        found=len(students),
        all=len(everybody),
        pages=pages,
        query=query,
    )


def _at_risk_in(risk: Risk | None, judged: Sequence[str]) -> bool:
    return risk is not None and (risk.assignment is None or risk.assignment in judged)


def _everybody(dashboard: Overview, members: Sequence[Member]) -> list[StudentLine]:
    active = {student.student for student in dashboard.students}
    idle = [
        StudentLine(
            student=member.id, name=member.name, sections=member.sections, total_score=0.0, assignments={}
        )
        for member in members
        if member.id not in active
    ]
    return [*dashboard.students, *idle]


def _row(student: StudentLine, ids: Sequence[str], risk: Risk | None) -> Row:
    name = "" if student.name == student.student else student.name
    cells = (student.assignments.get(id_) for id_ in ids)
    return Row(
        student=student,
        name=name,
        risk=risk,
        cells=tuple(
            DrawnCell(assignment=id_, look=_look(cell), cell=cell)
            for id_, cell in zip(ids, cells, strict=True)
        ),
    )


def _look(cell: Cell | None) -> str:
    if cell is None:
        return "none"
    if cell.best_score is not None and cell.max_score is not None:
        return "full" if cell.best_score >= cell.max_score else "passed" if cell.passed else "low"
    return "fault" if cell.state is SubmissionState.INFRASTRUCTURE_ERROR else "waiting"


def _fits(student: StudentLine, judged: Sequence[str], show: Show) -> bool:
    if show == "all":
        return True
    return any(_CONDITIONS[show](student.assignments.get(id_)) for id_ in judged)


_CONDITIONS: Mapping[Show, Callable[[Cell | None], bool]] = {
    "unfinished": lambda cell: cell is None or not cell.passed,
    "not_begun": lambda cell: cell is None,
    "stuck": lambda cell: cell is not None and cell.stuck,
    "waiting": lambda cell: cell is not None and cell.state in _WAITING,
    "judge": lambda cell: cell is not None and cell.waits_for_person,
    "fault": lambda cell: cell is not None and cell.state is SubmissionState.INFRASTRUCTURE_ERROR,
}


def _sort_key(sort: str) -> Callable[[StudentLine], Any]:
    if sort == "total":
        return lambda one: (one.total_score, one.student)
    if sort == "section":
        return lambda one: (one.sections, one.student)
    if sort == "activity":
        return lambda one: (
            max((cell.last_activity_at for cell in one.assignments.values()), default=_NEVER),
            one.student,
        )
    if sort == "student":
        return lambda one: one.student
    return lambda one: (_score(one.assignments.get(sort)), one.student)


def _score(cell: Cell | None) -> float:
    return -1.0 if cell is None or cell.best_score is None else cell.best_score
