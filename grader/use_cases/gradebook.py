"""Grades for other systems: the gradebook, also as CSV, and single reports in other graders' formats.

The CSV is a plain table, or the one that Canvas imports.
"""

from collections.abc import Mapping, Sequence
from typing import Literal

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import StudentProgress
from grader.contracts.identity import Caller, Member, Role
from grader.contracts.judgement import judged
from grader.contracts.notation import written
from grader.contracts.rubric import summed
from grader.contracts.text import Language
from grader.render.documents import to_gradescope, to_prairielearn
from grader.sheets.writing import as_text, csv_table
from grader.use_cases.callers import require_staff
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded

Format = Literal["plain", "canvas"]
Platform = Literal["gradescope", "prairielearn"]
Scores = Mapping[tuple[str, str], StudentProgress]


def book(services: Services, caller: Caller) -> tuple[Sequence[Member], Scores]:
    """Return everybody who has a line in the gradebook, and what they reached by student and assignment.

    Without courses, everybody who handed something in has one.

    Raises:
        RefusedError: the caller may not see the class.
    """
    require_staff(caller)
    progress = services.dashboard.state(caller.course).progress
    members = services.courses.members(caller.course, Role.STUDENT) or _seen(
        {one.student for one in progress}
    )
    return members, {(one.student, one.assignment): one for one in progress}


def gradebook_csv(services: Services, caller: Caller, language: Language, format: Format) -> str:
    """Return the whole gradebook as a file.

    Raises:
        RefusedError: the caller may not see the class.
    """
    members, scores = book(services, caller)
    assignments = services.assignments.all()
    if format == "canvas":
        return canvas(members, assignments, scores, language)
    return plain(members, assignments, scores)


def exported(
    services: Services, caller: Caller, submission_id: str, platform: Platform, language: Language
) -> dict[str, object]:
    """Return the report of a submission for a platform, as the caller may see it, with the points people gave.

    Raises:
        RefusedError: there is no such submission, or no grading yet.
    """
    _, stored = graded(services, caller, submission_id)
    if platform == "prairielearn":
        return to_prairielearn(judged(stored), language)
    return to_gradescope(judged(stored), language, stored.sha256)


def plain(members: Sequence[Member], assignments: Sequence[Assignment], scores: Scores) -> str:
    """Return one line per student and per assignment one column of points and one of attempts."""
    head = ["student", "name"]
    for assignment in assignments:
        head += [f"{assignment.id} ({written(assignment.max_score)})", f"{assignment.id} attempts"]
    rows: list[list[str]] = [[*head, "total"]]
    for member in members:
        cells = [as_text(member.id), as_text(member.name)]
        reached = [scores.get((member.id, assignment.id)) for assignment in assignments]
        for progress in reached:
            cells += [_points(progress), "0" if progress is None else str(progress.attempts)]
        total = summed(one.counted_score or 0.0 for one in reached if one is not None)
        rows.append([*cells, written(total)])
    return csv_table(rows, safe=False)


def canvas(
    members: Sequence[Member], assignments: Sequence[Assignment], scores: Scores, language: Language
) -> str:
    """Return what Canvas imports as grades.

    The columns before the first assignment and the line ``Points Possible`` are as Canvas exports them; students
    are matched by ``SIS User ID``, and columns it does not know become assignments (Canvas Instructor Guide, "How
    do I import grades in the Gradebook?"). A student without a score has an empty cell, which changes nothing.
    The byte order mark is for Excel and does Canvas no harm: it looks for "Student" anywhere in the first cell
    (``GradebookImporter#row_has_student_headers?``), and writes the mark itself for users who ask for it. The
    first cell must not be quoted, though.
    """
    head = ["Student", "ID", "SIS User ID", "SIS Login ID", "Section"]
    titles = [as_text(f"{one.title.get(language)} [{one.id}]") for one in assignments]
    possible = ["    Points Possible", "", "", "", "", *(written(one.max_score) for one in assignments)]
    rows = [[*head, *titles], possible]
    for member in members:
        person = [as_text(member.name or member.id), "", as_text(member.id), as_text(member.id), ""]
        rows.append([*person, *(_points(scores.get((member.id, one.id))) for one in assignments)])
    return csv_table(rows, safe=False)


def _seen(students: set[str]) -> tuple[Member, ...]:
    return tuple(Member(course="", id=one, name="", role=Role.STUDENT) for one in sorted(students))


def _points(progress: StudentProgress | None) -> str:
    return "" if progress is None or progress.counted_score is None else written(progress.counted_score)
