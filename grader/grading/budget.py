"""How much a script may write into its report: all runs share one budget of text, and what is cut bears a mark."""

import json
from collections.abc import Iterable
from dataclasses import replace
from itertools import chain
from typing import Any, Final, TypeVar

from grader.contracts.outcome import Note, RunOutcome, Stream, StudentError
from grader.contracts.report import CaseOutput

REPORT_TEXT_BYTES: Final = 512 * 1024
"""Of errors, notes, names, logs and output. A report is held in memory several times while it is stored and shown,
and every reader loads the whole of it."""

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


def outputs_within_budget(outputs: Iterable[CaseOutput]) -> tuple[CaseOutput, ...]:
    """Return the outputs that are kept beside a report, cut to a budget of their own."""
    whole = tuple(outputs)
    share = REPORT_TEXT_BYTES // (2 * max(len(whole), 1))
    return tuple(
        replace(output, stdout=_cut_stream(output.stdout, share), stderr=_cut_stream(output.stderr, share))
        for output in whole
    )


def _surely_fits(outcome: RunOutcome, share: int) -> bool:
    errors = [error for error in (outcome.error, outcome.cleanup_error) if error is not None]
    texts = chain(
        (outcome.stdout.text, outcome.stderr.text, outcome.detail),
        chain.from_iterable((error.type, error.message, error.traceback) for error in errors),
        chain.from_iterable((log.name, log.message) for log in outcome.logs),
        chain.from_iterable((note.code, note.text) for note in outcome.notes),
        chain.from_iterable((end.node, end.name, end.type) for end in outcome.endpoints),
        outcome.nodes,
    )
    records = len(errors) + len(outcome.logs) + len(outcome.notes) + len(outcome.endpoints)
    return _MOST_ESCAPED * sum(map(len, texts)) + _PER_RECORD * records <= share


class _Purse:
    """What is left of one run's share."""

    def __init__(self, share: int) -> None:
        self._most = share // 6  # for one kind of text
        self.left = share
        self.cut: list[str] = []

    def first(
        self, name: str, items: tuple[_Item, ...], texts: Iterable[tuple[str, ...]]
    ) -> tuple[_Item, ...]:
        """Return the first of `items`, whose texts are `texts`, that fit."""
        left = self._most
        for index, parts in enumerate(texts):
            size = _bytes(*parts)
            if size > left:
                self.cut.append(name)
                items = items[:index]
                break
            left -= size
        self.left -= self._most - left
        return items

    def text(self, name: str, text: str, most: int) -> str:
        """Return beginning and end of `text`, if it is longer than `most` bytes."""
        shown = _cut_text(text, most)
        if shown is not text:
            self.cut.append(name)
        self.left -= _bytes(shown)
        return shown

    def error(self, name: str, error: StudentError | None) -> StudentError | None:
        """Return `error` with its texts cut."""
        if error is None:
            return None
        part = self._most // 8
        texts: dict[str, Any] = {
            "type": self.text(name, error.type, part),
            "message": self.text(name, error.message, 2 * part),
            "traceback": self.text(name, error.traceback, 4 * part),
        }
        return replace(error, **texts)


def _cut(outcome: RunOutcome, share: int) -> RunOutcome:
    """Take in order what the feedback needs most; the output of the script shares what is left."""
    purse = _Purse(share)
    fields: dict[str, Any] = {
        "error": purse.error("error", outcome.error),
        "cleanup_error": purse.error("cleanup_error", outcome.cleanup_error),
        "detail": purse.text("detail", outcome.detail, share // 20),
        "notes": purse.first("notes", outcome.notes, ((note.code, note.text) for note in outcome.notes)),
        "nodes": purse.first("nodes", outcome.nodes, ((node,) for node in outcome.nodes)),
        "endpoints": purse.first(
            "endpoints",
            outcome.endpoints,
            ((endpoint.node, endpoint.name, endpoint.type) for endpoint in outcome.endpoints),
        ),
        "logs": purse.first("logs", outcome.logs, ((log.name, log.message) for log in outcome.logs)),
    }
    for name in ("stdout", "stderr"):
        stream: Stream = getattr(outcome, name)
        fields[name] = _cut_stream(stream, purse.left // 2)
        if fields[name] is not stream:
            purse.cut.append(name)
    if purse.cut:
        named = ", ".join(dict.fromkeys(purse.cut))
        fields["notes"] = (*fields["notes"], Note(code=CUT_NOTE, text=named))
    dropped = outcome.logs_dropped + len(outcome.logs) - len(fields["logs"])
    return replace(outcome, logs_dropped=dropped, **fields)


def _cut_text(text: str, most: int) -> str:
    if _bytes(text) <= most:
        return text
    half = max(most - _bytes(_MARK), 0) // (2 * _MOST_ESCAPED)
    return text[:half] + _MARK + text[len(text) - half :]


def _cut_stream(stream: Stream, most: int) -> Stream:
    """Keep the beginning and the end of a stream that is too long."""
    text = _cut_text(stream.text, most)
    if text is stream.text:
        return stream
    half = (len(text) - len(_MARK)) // 2
    left_out = len(stream.text[half : len(stream.text) - half].encode())
    return Stream(text=text, dropped_bytes=stream.dropped_bytes + left_out)


def _bytes(*texts: str) -> int:
    return _PER_RECORD + sum(len(json.dumps(text, ensure_ascii=False).encode()) for text in texts)
