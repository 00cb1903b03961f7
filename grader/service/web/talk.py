"""The conversation of a run as the page draws it: a lane for each topic, service and action; all of it as rows."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from grader.contracts.conversation import Saying
from grader.contracts.text import Language
from grader.messages import on_page
from grader.messages.quantity import number

MOST_LANES: Final = 20
_MOST_ROWS: Final = 200
_ARROWS: Final = {"in": "→", "call": "→", "out": "←", "ask": "←"}
_NS_PER_S: Final = 1e9


@dataclass(frozen=True, slots=True)
class TalkMark:
    """Something that was said, at a place of the time axis in percent.

    Attributes:
        kind: as `Saying.way`; ``silent``: a call without an answer.
        end: where the answer came; None: there is none, or none is due.
        told: what was said, and when.
    """

    kind: str
    begin: str
    end: str | None
    told: str


@dataclass(frozen=True, slots=True)
class TalkLane:
    """What was said on one topic, service or action."""

    name: str
    marks: tuple[TalkMark, ...]
    summary: str


@dataclass(frozen=True, slots=True)
class TalkRow:
    """A line of the table."""

    time: str
    arrow: str
    name: str
    text: str


@dataclass(frozen=True, slots=True)
class TalkPage:
    """The drawing, its time axis from 0 to `end`, and the table; `left_out` rows are too many."""

    lanes: tuple[TalkLane, ...]
    rows: tuple[TalkRow, ...]
    end: str
    left_out: int


def talk_page(sayings: Sequence[Saying], duration_ns: int, language: Language) -> TalkPage | None:
    """Return what a page shows of a conversation; None where nothing was said."""
    if not sayings:
        return None
    names = list(dict.fromkeys(said.name for said in sayings))[:MOST_LANES]
    end_ns = max([duration_ns, 1, *(said.until_ns or said.t_ns for said in sayings)])
    lanes = [_lane([said for said in sayings if said.name == name], end_ns, language) for name in names]
    rows = [TalkRow(_time(said), _ARROWS[said.way], said.name, _told(said, language)) for said in sayings]
    end = number(end_ns / _NS_PER_S, "s")
    return TalkPage(tuple(lanes), tuple(rows[:_MOST_ROWS]), end, max(len(rows) - _MOST_ROWS, 0))


def _lane(sayings: Sequence[Saying], end_ns: int, language: Language) -> TalkLane:
    marks = tuple(_mark(said, end_ns, language) for said in sayings)
    counts = {kind: sum(mark.kind == kind for mark in marks) for kind in dict.fromkeys(m.kind for m in marks)}
    told = [on_page(language, f"talk.{kind}", count=count) for kind, count in counts.items()]
    return TalkLane(sayings[0].name, marks, on_page(language, "comma").join(told))


def _mark(said: Saying, end_ns: int, language: Language) -> TalkMark:
    is_silent = said.way in ("call", "ask") and said.until_ns is None
    end = None if said.until_ns is None else _place(said.until_ns, end_ns)
    told = f"{_time(said)}  {_told(said, language)}"
    return TalkMark("silent" if is_silent else said.way, _place(said.t_ns, end_ns), end, told)


def _place(t_ns: int, end_ns: int) -> str:
    return f"{1.0 + 98.0 * t_ns / end_ns:.2f}%"  # not at the edges, where half of a mark would be cut off


def _time(said: Saying) -> str:
    return number(said.t_ns / _NS_PER_S, "s", 3)


def _told(said: Saying, language: Language) -> str:
    if said.way not in ("call", "ask"):
        return said.text
    if said.until_ns is None:
        return f"{said.text}  {on_page(language, 'no_answer')}"
    took = number((said.until_ns - said.t_ns) / _NS_PER_S, "s", 3)
    return f"{said.text}  {on_page(language, 'answered_after', time=took)}"
