"""Two gradings side by side. A pure function of the two reports and files."""

import difflib
from dataclasses import dataclass

from grader.contracts.report import GradeReport
from grader.contracts.text import Language
from grader.contracts.upload import lines_of
from grader.service.web.result import ItemLine, ResultPage, item_line, result_page

_MOST_LINES = 1_000
_CONTEXT_LINES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class ItemPair:
    """One rubric item in both gradings, None where it does not occur; `change` is in points."""

    title: str
    first: ItemLine | None
    second: ItemLine | None
    change: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DiffLine:
    """One line of a unified diff. `kind`: added, removed, place or same."""

    kind: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Two gradings. `diff` is None when the files are too long to be compared line by line."""

    first: ResultPage
    second: ResultPage
    items: tuple[ItemPair, ...]
    diff: tuple[DiffLine, ...] | None


def compare(
    first: GradeReport, second: GradeReport, first_source: str, second_source: str, language: Language
) -> Comparison:
    """Return the rubric items of both in the order of the later one, and how the file changed."""
    before = {item.id: item for item in first.items}
    after = {item.id: item for item in second.items}
    pairs = []
    for item_id in dict.fromkeys([*after, *before]):
        old, new = before.get(item_id), after.get(item_id)
        named = new or old
        pairs.append(
            ItemPair(
                title="" if named is None else named.title.get(language),
                first=None if old is None else item_line(old, language),
                second=None if new is None else item_line(new, language),
                change=round((0.0 if new is None else new.earned) - (0.0 if old is None else old.earned), 2),
            )
        )
    return Comparison(
        first=result_page(first, None, language),
        second=result_page(second, None, language),
        items=tuple(pairs),
        diff=changes(first_source, second_source),
    )


def changes(before: str, after: str) -> tuple[DiffLine, ...] | None:
    """Return the lines in which two files differ, and some around; None when they are too long for that."""
    first, second = lines_of(before), lines_of(after)
    if max(len(first), len(second)) > _MOST_LINES:
        return None
    lines = difflib.unified_diff(first, second, n=_CONTEXT_LINES, lineterm="")
    kinds = {"+": "added", "-": "removed", "@": "place"}
    body = list(lines)[2:]  # without the two lines of file names
    return tuple(DiffLine(kind=kinds.get(line[:1], "same"), text=line) for line in body)
