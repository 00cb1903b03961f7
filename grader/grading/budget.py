"""How much a script may write into its report: all runs share one budget of text, and what is cut bears a mark."""

import json
from collections.abc import Iterable
from dataclasses import replace
from itertools import chain
from typing import Final, TypeVar

from grader.contracts.outcome import Note, RunOutcome, Stream

REPORT_TEXT_BYTES: Final = 512 * 1024
"""Of logs, notes, endpoints and output. A report is held in memory several times while it is stored and shown, and
every reader loads the whole of it."""

CUT_NOTE: Final = "report_cut"
"""Names what of a run did not fit into its report."""

_Item = TypeVar("_Item")

_MOST_ESCAPED: Final = 6  # bytes of one character in JSON, such as \u0001
_PER_RECORD: Final = 80  # its keys and numbers
_MARK: Final = "\n… cut: the report would be too long …\n"


def within_budget(outcomes: Iterable[RunOutcome]) -> list[RunOutcome]:
    """Return `outcomes` with what does not fit into the report left out; each has the same share of it."""
    whole = list(outcomes)
    share = REPORT_TEXT_BYTES // max(len(whole), 1)
    return [outcome if _surely_fits(outcome, share) else _cut(outcome, share) for outcome in whole]


def _surely_fits(outcome: RunOutcome, share: int) -> bool:
    texts = chain(
        (outcome.stdout.text, outcome.stderr.text),
        chain.from_iterable((log.name, log.message) for log in outcome.logs),
        chain.from_iterable((note.code, note.text) for note in outcome.notes),
        chain.from_iterable((end.node, end.name, end.type) for end in outcome.endpoints),
        outcome.nodes,
    )
    records = len(outcome.logs) + len(outcome.notes) + len(outcome.endpoints)
    return _MOST_ESCAPED * sum(map(len, texts)) + _PER_RECORD * records <= share


def _cut(outcome: RunOutcome, share: int) -> RunOutcome:
    """Take in order what the feedback needs most; logs and output share what is left."""
    notes, left = _first(outcome.notes, [_bytes(n.code, n.text) for n in outcome.notes], share // 4)
    spent = share // 4 - left
    named = [_bytes(end.node, end.name, end.type) for end in outcome.endpoints]
    endpoints, left = _first(outcome.endpoints, named, share // 4)
    spent += share // 4 - left
    logs, left = _first(outcome.logs, [_bytes(log.name, log.message) for log in outcome.logs], share // 4)
    rest = share - spent - (share // 4 - left)
    stdout = _cut_stream(outcome.stdout, rest // 2)
    stderr = _cut_stream(outcome.stderr, rest // 2)
    parts = {
        "notes": len(notes) < len(outcome.notes),
        "endpoints": len(endpoints) < len(outcome.endpoints),
        "logs": len(logs) < len(outcome.logs),
        "stdout": stdout is not outcome.stdout,
        "stderr": stderr is not outcome.stderr,
    }
    cut = ", ".join(name for name, is_cut in parts.items() if is_cut)
    return replace(
        outcome,
        notes=(*notes, Note(code=CUT_NOTE, text=cut)) if cut else notes,
        endpoints=endpoints,
        logs=logs,
        logs_dropped=outcome.logs_dropped + len(outcome.logs) - len(logs),
        stdout=stdout,
        stderr=stderr,
    )


def _first(items: tuple[_Item, ...], sizes: list[int], budget: int) -> tuple[tuple[_Item, ...], int]:
    """Return the first of `items` that fit into `budget`, and what they leave of it."""
    for index, size in enumerate(sizes):
        if size > budget:
            return items[:index], budget
        budget -= size
    return items, budget


def _cut_stream(stream: Stream, budget: int) -> Stream:
    """Keep the beginning and the end of a stream that is too long."""
    if _bytes(stream.text) <= budget:
        return stream
    half = budget // (2 * _MOST_ESCAPED)
    left_out = len(stream.text[half : len(stream.text) - half].encode())
    text = stream.text[:half] + _MARK + stream.text[len(stream.text) - half :]
    return Stream(text=text, dropped_bytes=stream.dropped_bytes + left_out)


def _bytes(*texts: str) -> int:
    return _PER_RECORD + sum(len(json.dumps(text, ensure_ascii=False).encode()) for text in texts)
