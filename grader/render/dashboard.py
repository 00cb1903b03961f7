"""The dashboard's JSON as tables: students by assignments, then one line per assignment.

Unknown fields are ignored and missing ones shown as a dash, so that an older client can show a newer
server's data.
"""

from collections.abc import Iterable, Mapping

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from grader.contracts.text import Language
from grader.render import quantity
from grader.render.escape import visible_line
from grader.render.labels import word

_NAME_CHARACTERS = 24
_HARDEST = 3


def render_dashboard(data: Mapping[str, object], *, language: Language) -> RenderableType:
    """Return the tables for ``GET /api/v1/dashboard``.

    Args:
        data: ``students``: list of ``{student, assignments}``, its assignments by id as ``{best_score,
            status, attempts}``; ``assignments``: by id, or a list of objects with ``id``, as ``{title,
            max_score, pass_rate, mean, submissions, most_failed}``; ``queue``: ``{state: count}``.
        language: of headings and titles.
    """
    assignments = _by_id(data.get("assignments"))
    students = [_mapping(entry) for entry in _list(data.get("students"))]
    parts: list[RenderableType] = [_students(students, assignments, language)]
    if any(_mapping(entry) for entry in assignments.values()):
        parts.append(_assignments(assignments, language))
    if queue := _mapping(data.get("queue")):
        counts = "  ".join(f"{_shown(state)} {_shown(count)}" for state, count in queue.items())
        parts.append(Text(f"{word('queue', language)}: {counts}"))
    return Group(*parts)


def _students(
    students: Iterable[Mapping[str, object]], assignments: Mapping[str, object], language: Language
) -> Table:
    rows = [(entry.get("student"), _by_id(entry.get("assignments"))) for entry in students]
    columns = list(assignments) or list(dict.fromkeys(key for _, cells in rows for key in cells))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(word("student", language), overflow="fold")
    for key in columns:
        table.add_column(
            Text(_title(key, _mapping(assignments.get(key)), language)), justify="right", no_wrap=True
        )
    for student, cells in rows:
        most = (_mapping(assignments.get(key)).get("max_score") for key in columns)
        marks = (_cell(_mapping(cells.get(key)), m) for key, m in zip(columns, most, strict=True))
        table.add_row(Text(visible_line(str(student), _NAME_CHARACTERS)), *marks)
    return table


def _cell(entry: Mapping[str, object], most: object) -> Text:
    if not entry:
        return Text(quantity.NOTHING, style="dim")
    best = entry.get("best_score")
    if not isinstance(best, int | float):
        return Text(_shown(entry.get("status")), style="yellow")
    attempts = entry.get("attempts")
    most = entry.get("max_score", most)
    full = isinstance(most, int | float) and best >= most
    tries = f" ×{attempts}" if isinstance(attempts, int) and attempts > 1 else ""
    return Text(f"{'✓ ' if full else ''}{quantity.score(best)}{tries}", style="green" if full else "yellow")


def _assignments(assignments: Mapping[str, object], language: Language) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(word("assignment", language), no_wrap=True)
    for key in ("submissions", "pass_rate", "mean"):
        table.add_column(word(key, language), justify="right", no_wrap=True)
    table.add_column(word("hardest", language), overflow="fold")
    for key, value in assignments.items():
        entry = _mapping(value)
        table.add_row(
            Text(_title(key, entry, language)),
            Text(_shown(entry.get("submissions"))),
            Text(_percent(entry.get("pass_rate"))),
            Text(_shown(entry.get("mean", entry.get("mean_score")))),
            Text(_hardest(_list(entry.get("most_failed", entry.get("most_failed_items"))), language)),
        )
    return table


def _hardest(items: list[object], language: Language) -> str:
    return ", ".join(_failed_item(item, language) for item in items[:_HARDEST]) or quantity.NOTHING


def _failed_item(item: object, language: Language) -> str:
    if not isinstance(item, Mapping):
        return _shown(item)
    count = item.get("count", item.get("failed"))
    name = _title(_shown(item.get("id", item.get("item"))), item, language)
    return name if count is None else f"{name} ({_shown(count)})"


def _title(key: str, entry: Mapping[str, object], language: Language) -> str:
    title = entry.get("title")
    if isinstance(title, Mapping):
        title = title.get(language)
    return visible_line(title if isinstance(title, str) and title else key, _NAME_CHARACTERS)


def _shown(value: object) -> str:
    if value is None:
        return quantity.NOTHING
    return quantity.score(value) if isinstance(value, float) else visible_line(str(value), 60)


def _percent(value: object) -> str:
    return f"{value * 100:.0f} %" if isinstance(value, int | float) else quantity.NOTHING


def _mapping(value: object) -> Mapping[str, object]:
    return value if isinstance(value, Mapping) else {}


def _list(value: object) -> list[object]:
    return value if isinstance(value, list) else []


def _by_id(value: object) -> Mapping[str, object]:
    """Return a mapping by id of either shape: the mapping itself, or a list of objects with ``id``."""
    if isinstance(value, list):
        entries = [_mapping(entry) for entry in value]
        return {str(entry.get("id", entry.get("assignment"))): entry for entry in entries}
    return _mapping(value)
