"""The gradebook as CSV: a plain table, and the one Canvas imports.

Cells that a spreadsheet program would take for a formula are made text by an apostrophe before them (OWASP,
"CSV Injection"); with an East Asian locale that is so for the full-width signs, too.
"""

import csv
import io
from collections.abc import Mapping, Sequence

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import Progress
from grader.contracts.identity import Member
from grader.contracts.notation import written
from grader.contracts.rubric import summed
from grader.contracts.text import BYTE_ORDER_MARK, Language

_FORMULA = ("=", "+", "-", "@", "＝", "＋", "－", "＠", "\t", "\r", "\n")
Scores = Mapping[tuple[str, str], Progress]


def plain(members: Sequence[Member], assignments: Sequence[Assignment], scores: Scores) -> str:
    """Return one line per student and per assignment one column of points and one of attempts."""
    head = ["student", "name"]
    for assignment in assignments:
        head += [f"{assignment.id} ({written(assignment.max_score)})", f"{assignment.id} attempts"]
    rows: list[list[str]] = [[*head, "total"]]
    for member in members:
        cells = [_text(member.id), _text(member.name)]
        reached = [scores.get((member.id, assignment.id)) for assignment in assignments]
        for progress in reached:
            cells += [_points(progress), "0" if progress is None else str(progress.attempts)]
        total = summed(one.counted_score or 0.0 for one in reached if one is not None)
        rows.append([*cells, written(total)])
    return _written(rows)


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
    titles = [_text(f"{one.title.get(language)} [{one.id}]") for one in assignments]
    possible = ["    Points Possible", "", "", "", "", *(written(one.max_score) for one in assignments)]
    rows = [[*head, *titles], possible]
    for member in members:
        person = [_text(member.name or member.id), "", _text(member.id), _text(member.id), ""]
        rows.append([*person, *(_points(scores.get((member.id, one.id))) for one in assignments)])
    return _written(rows)


def _points(progress: Progress | None) -> str:
    return "" if progress is None or progress.counted_score is None else written(progress.counted_score)


def _text(value: str) -> str:
    return "'" + value if value.startswith(_FORMULA) else value


def _written(rows: Sequence[Sequence[str]]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\r\n").writerows(rows)
    return BYTE_ORDER_MARK + out.getvalue()
