"""A handed-in file as its page shows it: numbered lines, with what is to be said about some of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from grader.contracts.report import CaseRun
from grader.contracts.upload import lines_of
from grader.formats.packages.bundle import line_in_text, text_of

_MOST_LINES = 2_000
_LONGEST_LINE = 500


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceLine:
    """One line of a file. `errors`: what ended the script there."""

    number: int
    text: str
    errors: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceView:
    """A file as a page shows it.

    Attributes:
        left_out: lines at the end that are not shown. cut: whether lines are shown in part.
    """

    lines: tuple[SourceLine, ...]
    left_out: int
    cut: bool


def source_view(source: bytes, errors: Mapping[int, Sequence[str]]) -> SourceView:
    """Return a file with `errors`, by line number, at their lines. Its size on a page is bounded."""
    lines = lines_of(text_of(source))
    shown = lines[:_MOST_LINES]
    return SourceView(
        lines=tuple(
            SourceLine(number=number, text=text[:_LONGEST_LINE], errors=tuple(errors.get(number, ())))
            for number, text in enumerate(shown, start=1)
        ),
        left_out=len(lines) - len(shown),
        cut=any(len(text) > _LONGEST_LINE for text in shown),
    )


def failing_lines(source: bytes, runs: Sequence[CaseRun]) -> dict[int, list[str]]:
    """Return by line of `source_view` what ended a run there, the same in several runs once."""
    found: dict[int, list[str]] = {}
    for run in runs:
        error = run.outcome.error
        if error is not None and error.line is not None:
            line = line_in_text(source, error.file, error.line)
            said, here = f"{error.type}: {error.message}", found.setdefault(line, [])
            if said not in here:
                here.append(said)
    return found
