"""The dashboard's JSON as tables: students by assignments, then one line per assignment.

Unknown fields are ignored and missing ones shown as a dash, so that client and server may differ in age.
"""

from collections.abc import Iterator, Mapping, Sequence

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from grader.contracts.report import GradeStatus
from grader.contracts.text import Language
from grader.messages import quantity, template
from grader.render.escape import visible_line
from grader.render.labels import word

_NAME_CHARACTERS = 24
_HARDEST = 3
_ASSIGNMENTS_PER_TABLE = 7  # as many as fit 80 columns beside names and totals
_CELL_COLUMNS = 6
_STYLES = {"✓": "green", "✗": "red", "": "yellow"}
_MANUAL = GradeStatus.NEEDS_MANUAL.value

Json = Mapping[str, object]


def render_dashboard(data: Json, *, language: Language) -> RenderableType:
    """Return the document of ``GET /api/v1/dashboard`` as tables, headings in `language`."""
    students = _objects(data.get("students"))
    assignments = _objects(data.get("assignments"))
    queue = _object(data.get("queue"))
    counts = "  ".join(f"{_state(state, language)} {_shown(count)}" for state, count in queue.items())
    colon = "：" if language == "zh" else ": "
    if isinstance(waiting := data.get("waiting_for_person"), int) and waiting:
        counts += f"  {word('waiting_for_person', language)} {waiting}"
    return Group(
        *_matrix(students, assignments, language),
        Text(_legend(data.get("pass_fraction"), language), style="dim"),
        _assignments(assignments, language),
        Text(f"{word('queue', language)}{colon}{counts or quantity.NOTHING}"),
    )


def _legend(pass_fraction: object, language: Language) -> str:
    """Return what the marks of the matrix mean."""
    return word("matrix_marks", language, share=_percent(pass_fraction))


def _matrix(students: Sequence[Json], assignments: Sequence[Json], language: Language) -> Iterator[Table]:
    """Yield students by assignments, a few assignments to a table; the last table has the totals."""
    starts = range(0, max(len(assignments), 1), _ASSIGNMENTS_PER_TABLE)
    for start in starts:
        some = assignments[start : start + _ASSIGNMENTS_PER_TABLE]
        yield _students(students, some, language, with_total=start == starts[-1])


def _students(
    students: Sequence[Json], assignments: Sequence[Json], language: Language, *, with_total: bool
) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column(word("student", language), no_wrap=True)
    for assignment in assignments:
        table.add_column(Text(_name(assignment), overflow="fold"), justify="right", min_width=_CELL_COLUMNS)
    if with_total:
        table.add_column(word("total", language), justify="right", no_wrap=True, min_width=_CELL_COLUMNS)
    for student in students:
        cells = _object(student.get("assignments"))
        marks = [_cell(_object(cells.get(str(assignment.get("id")))), language) for assignment in assignments]
        if with_total:
            marks.append(Text(_shown(student.get("total_score"))))
        table.add_row(Text(visible_line(str(student.get("student")), _NAME_CHARACTERS)), *marks)
    return table


def _cell(entry: Json, language: Language) -> Text:
    """Return the best score, ``✓`` or ``✗`` before full marks or too few, ``×n`` after more than one attempt."""
    if not entry:
        return Text(quantity.NOTHING, style="dim")
    best, most, attempts = entry.get("best_score"), entry.get("max_score"), entry.get("attempts")
    if not isinstance(best, int | float) and entry.get("verdict") == _MANUAL:
        return Text(word("not_yet", language), style="cyan")
    if not isinstance(best, int | float):
        return Text(_state(entry.get("status"), language), style="yellow")
    full = isinstance(most, int | float) and best >= most
    mark = "✓" if full else "✗" if entry.get("passed") is False else ""
    tries = f"×{attempts}" if isinstance(attempts, int) and attempts > 1 else ""
    return Text(f"{mark}{quantity.points(best)}{tries}", style=_STYLES[mark])


def _assignments(assignments: Sequence[Json], language: Language) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(word("assignment", language), overflow="fold")
    for key in ("submissions", "pass_rate", "mean"):
        table.add_column(word(key, language), justify="right", no_wrap=True)
    table.add_column(word("hardest", language), overflow="fold")
    for assignment in assignments:
        hardest = _objects(assignment.get("most_failed_items"))[:_HARDEST]
        table.add_row(
            Text(_name(assignment)),
            Text(_shown(assignment.get("submissions"))),
            Text(_percent(assignment.get("pass_rate"))),
            Text(_shown(assignment.get("mean_score"))),
            Text(
                ", ".join(f"{_name(item)} ×{_shown(item.get('count'))}" for item in hardest)
                or quantity.NOTHING
            ),
        )
    return table


def _state(state: object, language: Language) -> str:
    return template(language, f"status.{state}") or _shown(state)


def _name(entry: Json) -> str:
    return visible_line(str(entry.get("title") or entry.get("id") or quantity.NOTHING), _NAME_CHARACTERS)


def _shown(value: object) -> str:
    if value is None:
        return quantity.NOTHING
    return quantity.points(value) if isinstance(value, float) else visible_line(str(value), _NAME_CHARACTERS)


def _percent(value: object) -> str:
    return quantity.number(value * 100, "%", 0) if isinstance(value, int | float) else quantity.NOTHING


def _object(value: object) -> Json:
    return value if isinstance(value, Mapping) else {}


def _objects(value: object) -> Sequence[Json]:
    return [_object(entry) for entry in value] if isinstance(value, list) else []
