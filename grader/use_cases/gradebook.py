"""Grades for other systems: the gradebook, also as files, and single reports in other graders' formats.

The files are a plain table, the one that Canvas imports, workbooks, and a teacher's own sheet with points in it.
"""

from collections.abc import Mapping, Sequence
from decimal import ROUND_HALF_UP, Decimal
from functools import partial
from typing import Literal

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import StudentProgress
from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import Caller, Member, Role
from grader.contracts.notation import written
from grader.contracts.rubric import summed
from grader.contracts.text import Language
from grader.formats.sheets.filling import FilledSheet, NoColumnError, fill
from grader.formats.sheets.writing import Cell, as_text, csv_table, workbook
from grader.messages import on_page
from grader.render.documents import to_gradescope, to_prairielearn
from grader.use_cases import people
from grader.use_cases.assignments import in_course, require_published
from grader.use_cases.callers import require_staff
from grader.use_cases.explaining import told_of
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded, hiding

Format = Literal["plain", "canvas"]
Platform = Literal["gradescope", "prairielearn"]
Scores = Mapping[tuple[str, str], StudentProgress]


def book(services: Services, caller: Caller, section: str = "") -> tuple[Sequence[Member], Scores]:
    """Return everybody who has a line in the gradebook, and what they reached by student and assignment.

    Without courses, everybody who handed something in has one. With `section`, only those who are in it.
    For staff.
    """
    require_staff(caller)
    progress = services.dashboard.state(caller.course, caller.students).progress
    members = people.members(services, caller, Role.STUDENT) or _unlisted({cell.student for cell in progress})
    if section:
        members = tuple(member for member in members if section in member.sections)
    return members, {(cell.student, cell.assignment): cell for cell in progress}


def gradebook_csv(services: Services, caller: Caller, format: Format, section: str = "") -> str:
    """Return the gradebook as CSV. For staff."""
    members, scores = book(services, caller, section)
    assignments = in_course(services, caller)
    if format == "canvas":
        return canvas(members, assignments, scores)
    return plain(members, assignments, scores, percentages(services, caller, members, scores))


def gradebook_workbook(services: Services, caller: Caller, language: Language, section: str = "") -> bytes:
    """Return the gradebook as a workbook: points in one sheet, what they mean in another. For staff."""
    members, scores = book(services, caller, section)
    assignments = in_course(services, caller)
    heading = partial(on_page, language)
    titles = [
        f"{assignment.title.get(language)} ({written(assignment.max_score)})" for assignment in assignments
    ]
    head = [
        heading("people.id"),
        heading("people.name"),
        heading("people.sections"),
        *titles,
        heading("total"),
        heading("gradebook.percent"),
    ]
    percent = percentages(services, caller, members, scores)
    rows: list[list[Cell]] = [[*head]]
    for member in members:
        reached = [_counted(scores.get((member.id, assignment.id))) for assignment in assignments]
        total = summed(points for points in reached if points is not None)
        rows.append([member.id, member.name, ", ".join(member.sections), *reached, total, percent[member.id]])
    notes: list[list[Cell]] = [
        [heading("gradebook.notes")],
        [heading("gradebook.lead")],
        [heading("gradebook.blank")],
    ]
    return workbook([(heading("nav.gradebook"), rows), (heading("gradebook.notes"), notes)])


def registry_workbook(  # noqa: PLR0913
    services: Services,
    caller: Caller,
    language: Language,
    *,
    column: str,
    assignment: str = "",
    section: str = "",
) -> bytes:
    """Return what a registry takes: id, name, and one column of points, in order of id.

    `column` is the header of the points: those of `assignment`; empty: the total in per cent (`percentages`).
    `section`: only its students; empty: all.

    Raises RefusedError: the caller may not see the class, or there is no such assignment.
    """
    members, points = _points_of(services, caller, assignment, section)
    head: list[Cell] = [on_page(language, "people.id"), on_page(language, "people.name"), column]
    rows = [head, *([member.id, member.name, points[member.id]] for member in members)]
    return workbook([(on_page(language, "nav.gradebook"), rows)])


def fill_in(
    services: Services, caller: Caller, content: bytes, column: str, assignment: str = ""
) -> FilledSheet:
    """Return a teacher's own sheet with points in a column; the rest as `registry_workbook`.

    `column`: its header; empty: the assignment's title or id.

    Raises as `registry_workbook`; or the sheet cannot be read, or has no such column: then the member `headings`
    has those that it has.
    """
    _, points = _points_of(services, caller, assignment, "")
    columns = [column] if column.strip() else _titles(services, caller, assignment)
    try:
        return fill(content, columns, points)
    except NoColumnError as error:
        raise RefusedError("invalid_sheet", error.text, field="file", headings=error.headings) from None
    except CourseError as error:
        raise RefusedError("invalid_sheet", error.text, field="file") from None


def _titles(services: Services, caller: Caller, assignment: str) -> list[str]:
    if not assignment:
        return [""]
    title = require_published(services, caller, assignment).title
    return [title.zh, title.en, assignment]


def _points_of(
    services: Services, caller: Caller, assignment: str, section: str
) -> tuple[Sequence[Member], Mapping[str, float | None]]:
    members, scores = book(services, caller, section)
    if assignment:
        require_published(services, caller, assignment)
        return members, {member.id: _counted(scores.get((member.id, assignment))) for member in members}
    return members, percentages(services, caller, members, scores)


def percentages(
    services: Services, caller: Caller, members: Sequence[Member], scores: Scores
) -> dict[str, float | None]:
    """Return what each reached of all assignments together, in per cent to one decimal, halves up.

    An assignment counts as much as the rules say (`weight`), else its points; what is not handed in earns nothing.
    None for whoever has no points at all; 0 where nothing counts.
    """
    rules, assignments = services.rules.of(caller.course), in_course(services, caller)
    weights = {assignment.id: rules.of(assignment.id).weight for assignment in assignments}
    shares = {
        assignment.id: (
            Decimal(repr(assignment.max_score)),
            Decimal(repr(assignment.max_score if weight is None else weight)),
        )
        for assignment in assignments
        if assignment.max_score and ((weight := weights[assignment.id]) is None or weight)
    }
    whole = sum((weight for _, weight in shares.values()), Decimal(0))
    by_student: dict[str, float | None] = {}
    for member in members:
        reached = {
            assignment.id: _counted(scores.get((member.id, assignment.id))) for assignment in assignments
        }
        earned = (
            Decimal(repr(points)) * shares[id_][1] / shares[id_][0]
            for id_, points in reached.items()
            if points is not None and id_ in shares
        )
        is_blank = all(points is None for points in reached.values())
        by_student[member.id] = None if is_blank else percentage(sum(earned, Decimal(0)), whole)
    return by_student


def percentage(points: Decimal | float, most: Decimal | float) -> float:
    """Return points in percent of the most there are, to one decimal, halves up; 0 where there are none."""
    if not most:
        return 0.0
    exact = Decimal(str(points)) * 100 / Decimal(str(most))
    return float(exact.quantize(Decimal("0.1"), ROUND_HALF_UP))


def _counted(progress: StudentProgress | None) -> float | None:
    return None if progress is None else progress.counted_score


def exported(
    services: Services, caller: Caller, submission_id: str, platform: Platform, language: Language
) -> dict[str, object]:
    """Return the report of a submission for a platform, as the caller may see it, with the points people gave.

    Raises RefusedError: there is no such submission, or no grading yet.
    """
    submission, stored = graded(services, caller, submission_id)
    student = Caller(course=submission.course)  # whoever asks, students read it there
    rules = services.rules.about(submission.course, submission.student, submission.assignment)
    report = told_of(services, student, submission, stored, rules).report
    hidden = hiding(services, submission).items if caller.is_staff else frozenset[str]()
    if platform == "prairielearn":
        return to_prairielearn(report, language, hidden=hidden)
    return to_gradescope(report, language, stored.sha256, hidden=hidden)


def plain(
    members: Sequence[Member],
    assignments: Sequence[Assignment],
    scores: Scores,
    percent: Mapping[str, float | None],
) -> str:
    """Return one line per student and per assignment one column of points and one of attempts; last the totals."""
    head = ["student", "name"]
    for assignment in assignments:
        head += [f"{assignment.id} ({written(assignment.max_score)})", f"{assignment.id} attempts"]
    rows: list[list[str]] = [[*head, "total", "percent"]]
    for member in members:
        cells = [as_text(member.id), as_text(member.name)]
        reached = [scores.get((member.id, assignment.id)) for assignment in assignments]
        for progress in reached:
            cells += [_points(progress), "0" if progress is None else str(progress.attempts)]
        total = summed(cell.counted_score or 0.0 for cell in reached if cell is not None)
        share = percent.get(member.id)
        rows.append([*cells, written(total), "" if share is None else written(share)])
    return csv_table(rows, safe=False)


def canvas(members: Sequence[Member], assignments: Sequence[Assignment], scores: Scores) -> str:
    """Return what Canvas imports as grades.

    Columns have one name in every language, so that a second import finds those of the first.
    The columns before the first assignment and the line ``Points Possible`` are as Canvas exports them; students
    are matched by ``SIS User ID``, and columns it does not know become assignments (Canvas Instructor Guide, "How
    do I import grades in the Gradebook?"). A student without a score has an empty cell, which changes nothing.
    The byte order mark is for Excel and does Canvas no harm: it looks for "Student" anywhere in the first cell
    (``GradebookImporter#row_has_student_headers?``), and writes the mark itself for users who ask for it. The
    first cell must not be quoted, though.
    """
    head = ["Student", "ID", "SIS User ID", "SIS Login ID", "Section"]
    titles = [as_text(f"{assignment.title.en} [{assignment.id}]") for assignment in assignments]
    possible = [
        "    Points Possible",
        "",
        "",
        "",
        "",
        *(written(assignment.max_score) for assignment in assignments),
    ]
    rows = [[*head, *titles], possible]
    for member in members:
        person = [
            as_text(member.name or member.id),
            "",
            as_text(member.id),
            as_text(member.id),
            as_text(" and ".join(member.sections)),
        ]
        rows.append(
            [*person, *(_points(scores.get((member.id, assignment.id))) for assignment in assignments)]
        )
    return csv_table(rows, safe=False)


def _unlisted(students: set[str]) -> tuple[Member, ...]:
    return tuple(Member(course="", id=student, name="", role=Role.STUDENT) for student in sorted(students))


def _points(progress: StudentProgress | None) -> str:
    points = _counted(progress)
    return "" if points is None else written(points)
