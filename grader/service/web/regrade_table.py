"""What a re-grade changes as its page shows it: by student and by rubric item. Pure functions."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal, get_args

from grader.contracts.assignment import Assignment
from grader.contracts.regrade import ItemChange, ScoreChange
from grader.contracts.text import Language
from grader.service.web.paging import PageQuery, cut
from grader.use_cases.assignments import item_title
from grader.use_cases.people import named

Part = Literal["all", "gain", "lose", "moved"]
PARTS: tuple[Part, ...] = get_args(Part)


class ChangesQuery(PageQuery):
    """Which changes are shown. `part`: all; those who gain, who lose; or whose points only move between items."""

    part: Part = "all"


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """Points from one number to another, None where there were or are none; `by` is the difference."""

    title: str
    before: float | None
    after: float | None
    by: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeLine:
    """One submission: its score, and the items that make the difference.

    `void` are the titles of items for which a person's judgement no longer counts.
    """

    submission: str
    student: str
    name: str
    score: Move
    items: tuple[Move, ...]
    void: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ItemTotal:
    """For how many submissions one item earns more or less."""

    title: str
    more: int
    less: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangesPage:
    """One page of the changes, and the items over all of them. `counts`: lines of each part."""

    lines: tuple[ChangeLine, ...]
    totals: tuple[ItemTotal, ...]
    counts: Mapping[Part, int]
    pages: int
    query: ChangesQuery


def changes(
    moved: Sequence[ScoreChange],
    assignment: Assignment | None,
    names: Mapping[str, str],
    language: Language,
    query: ChangesQuery,
) -> ChangesPage:
    """Return the page of what `moved` that `query` asks for; beyond the last page, the last."""
    titles = partial(item_title, assignment, language=language)
    fitting = {part: [change for change in moved if _FITS[part](change.by)] for part in PARTS}
    lines, query, pages = cut(fitting[query.part], query)
    return ChangesPage(
        lines=tuple(_line(line, names, titles) for line in lines),
        totals=tuple(_totals(moved, titles)),
        counts={part: len(found) for part, found in fitting.items()},
        pages=pages,
        query=query,
    )


_FITS: Mapping[Part, Callable[[float], bool]] = {
    "all": lambda by: True,
    "gain": lambda by: by > 0,
    "lose": lambda by: by < 0,
    "moved": lambda by: by == 0,
}


def _line(change: ScoreChange, names: Mapping[str, str], titles: Callable[[str], str]) -> ChangeLine:
    return ChangeLine(
        submission=change.submission,
        student=change.student,
        name=named(names, change.student),
        score=_move("", change),
        items=tuple(_move(titles(item.item), item) for item in change.items),
        void=tuple(titles(item) for item in change.void),
    )


def _move(title: str, change: ScoreChange | ItemChange) -> Move:
    return Move(title=title, before=change.before, after=change.after, by=change.by)


def _totals(found: Sequence[ScoreChange], titles: Callable[[str], str]) -> Iterable[ItemTotal]:
    more: Counter[str] = Counter()
    less: Counter[str] = Counter()
    for item in (item for change in found for item in change.items):
        (more if item.by >= 0 else less)[item.item] += 1
    for item_id in dict.fromkeys(item.item for change in found for item in change.items):
        yield ItemTotal(title=titles(item_id), more=more[item_id], less=less[item_id])
