"""The readable table of `grader check`.

Text from a submission passes `grader.render.escape.visible` and enters rich only as `rich.text.Text`, whose
content is never read as markup.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from types import MappingProxyType
from typing import TextIO

from rich import box
from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from grader.contracts.assignment import Assignment
from grader.contracts.explanation import ChangedText, Explanation
from grader.contracts.outcome import LogRecord, RunOutcome, Stream, StudentError
from grader.contracts.report import GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.text import EMPTY, Language
from grader.contracts.text import Text as Sentence
from grader.messages import quantity
from grader.messages.details import explained
from grader.render.captured import without_logs
from grader.render.escape import visible, visible_line
from grader.render.labels import (
    ITEM_MARK,
    cleanup_sentence,
    item_status_word,
    note_sentence,
    status_word,
    word,
)
from grader.render.prose import Prose
from grader.render.steps import own_hints, steps, told

_STYLE = {
    ItemStatus.PASSED: "green",
    ItemStatus.PARTIAL: "yellow",
    ItemStatus.FAILED: "red",
    ItemStatus.NOT_CHECKED: "dim",
    ItemStatus.NEEDS_MANUAL: "cyan",
}
_SAID_BY_COLUMNS = {ItemStatus.PASSED, ItemStatus.NOT_CHECKED, ItemStatus.NEEDS_MANUAL}
_WANTED_COLUMNS = 24
_LONGEST_LINE = 160
_HEAD_LINES = 12
_TAIL_LINES = 28
_NANO = 1e-9


def console(stream: TextIO | None = None, width: int | None = None) -> Console:
    """Return a console that colours terminals only and reads no markup in what it prints."""
    return Console(file=stream, width=width, markup=False, emoji=False, highlight=False)


def render_report(  # noqa: PLR0913
    report: GradeReport,
    *,
    language: Language,
    file_name: str,
    title: Sentence,
    cases: Mapping[str, Sentence] = MappingProxyType({}),
    show_logs: bool = False,
    show_steps: bool = True,
) -> RenderableType:
    """Return score, next step, the script's errors, rubric table and notes as one renderable.

    What to do comes first, as on the page: below a table it is overlooked. Without `show_steps` it is left for
    `render_steps`. `cases`: titles by id, which stand above the items of each where there are several.
    """
    return Group(
        _header(report, language, file_name, title),
        *(_next_steps(report, language) if show_steps else ()),
        *_errors(report, language, cases),
        _rubric(report, language, cases),
        *_notes(report, language),
        *(_outputs(report, language, cases) if show_logs else ()),
    )


def render_steps(
    report: GradeReport, explanation: Explanation, assignment: Assignment, language: Language
) -> Iterator[RenderableType]:
    """Yield what to do, from what was measured over the line to what to write: the reader may ask for each.

    That is what was tried and gains, or what the run shows, as far as the assignment lets it be told; and where
    nothing gains, the report's hints.
    """
    own = own_hints(assignment, report)
    if own and explanation.changes:
        yield next_steps(
            (visible(sentence.get(language)) for sentence in dict.fromkeys(own.values())), language
        )
    explained = steps(report, explanation, assignment.hints)
    for step in explained:
        yield next_steps((visible(step.fact.get(language)),), language)
        if step.line != EMPTY:
            yield Text(f"  {visible_line(step.line.get(language), _LONGEST_LINE)}")
        if step.change != EMPTY:
            yield Group(Prose(f"  {visible(step.change.get(language))}"), *_changed(step.lines))
    if not explained:
        yield Group(*_next_steps(told(report, Explanation(), assignment.hints, own), language))


def _changed(lines: Iterable[ChangedText]) -> Iterator[RenderableType]:
    for line in lines:
        for mark, text, style in (("-", line.before, "red"), ("+", line.after, "green")):
            if text is not None:
                yield Text(f"{line.number:5} {mark} {visible_line(text, _LONGEST_LINE)}", style=style)


def log_line(record: LogRecord) -> str:
    """Return one log record as ``[   1.500] [INFO] [node]: message``, escaped, on one line."""
    where = visible_line(record.name, 80)
    return (
        f"[{record.t_ns * _NANO:8.3f}] [{record.level_name}] [{where}]: {visible_line(record.message, 2000)}"
    )


def _header(report: GradeReport, language: Language, file_name: str, title: Sentence) -> RenderableType:
    line = Table.grid(expand=True, padding=(0, 1))
    line.add_column(ratio=1, overflow="fold")
    line.add_column(justify="right", no_wrap=True)
    left = Text.assemble(
        (visible_line(title.get(language)), "bold"), "  ", (visible_line(file_name, 60), "cyan")
    )
    line.add_row(left, _score(report, language))
    parts: list[RenderableType] = [line]
    if report.status is not GradeStatus.GRADED:
        parts.append(Text(status_word(report.status, language), style="bold red"))
    if summary := report.summary.get(language):
        parts.append(Prose(visible(summary)))
    return Group(*parts)


def _score(report: GradeReport, language: Language) -> Text:
    most = quantity.points(report.max_score)
    if report.score is None:
        return Text(f"{word('score', language)} {word('not_yet', language)} / {most}", style="bold yellow")
    full = report.score >= report.max_score
    text = Text(f"{word('score', language)} {quantity.points(report.score)} / {most}")
    if full:
        text.append(f" {word('full_marks', language)}")
    text.stylize("bold green" if full else "bold yellow")
    return text


def _rubric(report: GradeReport, language: Language, cases: Mapping[str, Sentence]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, expand=True, pad_edge=False, show_edge=True)
    table.add_column(word("status", language), no_wrap=True)
    table.add_column(word("item", language), ratio=1, overflow="fold")
    table.add_column(word("points", language), justify="right", no_wrap=True)
    table.add_column(word("measured", language), justify="right", no_wrap=True)
    table.add_column(word("wanted", language), overflow="fold", max_width=_WANTED_COLUMNS)
    above = ""
    for item in report.items:
        case = item.id.rpartition("/")[0]
        if case != above and case in cases:
            table.add_row("", Text(visible_line(cases[case].get(language)), style="bold"), "", "", "")
        above = case
        style = _STYLE[item.status]
        mark = Text(f"{ITEM_MARK[item.status]} {item_status_word(item.status, language)}", style=style)
        points = f"{quantity.points(item.earned)}/{quantity.points(item.points)}"
        table.add_row(
            mark,
            _item(item, language),
            points,
            Text(quantity.measured(item, language)),
            Text(visible_line(quantity.wanted(item, language))),
        )
    return table


def _item(item: RubricItem, language: Language) -> Text:
    """Return the title and, where points were lost, why; the other columns say the rest."""
    text = Prose(visible_line(item.title.get(language)))
    if item.status not in _SAID_BY_COLUMNS and (message := item.message.get(language)):
        text.append(f"\n{visible(message)}", style="dim")
    return text


def _next_steps(report: GradeReport, language: Language) -> Iterator[RenderableType]:
    """Yield the report's hint, and where mistakes were recognised those of its items, each once for all cases."""
    hints: dict[str, str] = {}
    of_items = [(item.id.rpartition("/")[2], item.hint) for item in report.items] if report.mistakes else []
    for name, hint in (("", report.hint), *of_items):
        line = visible(hint.get(language))
        if line and line not in hints.values():
            hints.setdefault(name, line)
    if hints:
        yield next_steps(hints.values(), language)


def next_steps(said: Iterable[str], language: Language) -> RenderableType:
    """Return what to do next, one line behind the other; each must be safe to show."""
    steps = Table.grid(padding=(0, 1))
    steps.add_column(no_wrap=True)
    steps.add_column(overflow="fold")
    for hint in said:
        steps.add_row(Text("→", style="bold cyan"), Prose(hint))
    return Group(Text(word("next_step", language), style="bold cyan"), Padding(steps, (0, 0, 0, 1)))


def _case_name(case: str, language: Language, cases: Mapping[str, Sentence]) -> str:
    return word("case", language, case=visible_line(cases[case].get(language) if case in cases else case))


def _errors(
    report: GradeReport, language: Language, cases: Mapping[str, Sentence]
) -> Iterator[RenderableType]:
    """Yield what ended the runs, the same end once; the first run with it is named unless all had it."""
    ends = [_end(run.outcome, report.hint, language) for run in report.runs]
    for end in dict.fromkeys(filter(any, ends)):
        heading, body = end
        if ends.count(end) < len(ends):
            heading += _case_name(report.runs[ends.index(end)].case, language, cases)
        yield Padding(Prose(heading, style="bold red" if body else ""), (1, 0, 0, 0))
        if body:
            yield Padding(Text(body), (0, 0, 0, 2))


def _end(outcome: RunOutcome, hint: Sentence, language: Language) -> tuple[str, str]:
    """Return where the script failed and its traceback, or why it was ended, unless `hint` says it; or nothing."""
    error = outcome.error
    if error is None:
        detail = explained(outcome.status, outcome.detail).get(language)
        return "" if detail in hint.get(language) else visible(detail), ""
    where = word("at_line", language, line=error.line) if error.line else ""
    body = error.traceback or f"{error.type}: {error.message}"
    return f"{word('your_error', language)}{where}", _shortened(visible(body).rstrip("\n"), language)


def _shortened(text: str, language: Language) -> str:
    lines = text.split("\n")
    left_out = len(lines) - _HEAD_LINES - _TAIL_LINES
    if left_out <= 1:
        return text
    note = word("left_out_lines", language, count=left_out)
    return "\n".join([*lines[:_HEAD_LINES], note, *lines[-_TAIL_LINES:]])


def _notes(report: GradeReport, language: Language) -> Iterator[RenderableType]:
    notes = list(dict.fromkeys(chain.from_iterable(run_notes(run.outcome, language) for run in report.runs)))
    if not notes:
        return
    yield Text(word("notes", language), style="bold")
    table = Table.grid(padding=(0, 1))
    for note in notes:
        table.add_row(Text("·"), Prose(note, style="dim"))
    yield Padding(table, (0, 0, 1, 1))


def run_notes(outcome: RunOutcome, language: Language) -> Iterator[str]:
    """Yield what is worth knowing about a run and costs nothing, safe to show."""
    if outcome.cleanup_error is not None:
        yield cleanup_sentence(outcome.cleanup_error, _in_short(outcome.cleanup_error, language), language)
    if outcome.nonfinite_commands:
        yield word("nonfinite", language, count=outcome.nonfinite_commands)
    for note in outcome.notes:
        yield visible(note_sentence(note, language))


def _in_short(error: StudentError, language: Language) -> str:
    where = word("at_line", language, line=error.line) if error.line else ""
    return f"{visible_line(error.type, 80)}: {visible_line(error.message, 300)}{where}"


def _outputs(
    report: GradeReport, language: Language, cases: Mapping[str, Sentence]
) -> Iterator[RenderableType]:
    for run in report.runs:
        name = _case_name(run.case, language, cases) if len(report.runs) > 1 else ""
        yield from _output(run.outcome, name, language)


def _output(outcome: RunOutcome, name: str, language: Language) -> Iterator[RenderableType]:
    logs = "\n".join(log_line(record) for record in outcome.logs)
    dropped = outcome.logs_dropped
    if logs:
        yield Rule(Text(word("logs", language) + name), align="left", style="dim")
        more = "\n" + word("more_logs", language, count=dropped) if dropped else ""
        yield Text(_shortened(logs, language) + more)
    for key, stream in (("stdout", outcome.stdout), ("stderr", outcome.stderr)):
        rest = without_logs(stream, outcome.logs)
        if rest.text or rest.dropped_bytes:
            yield Rule(Text(word(key, language) + name), align="left", style="dim")
            yield Text(_stream(rest, language))


def _stream(stream: Stream, language: Language) -> str:
    text = _shortened(visible(stream.text).rstrip("\n"), language)
    if stream.dropped_bytes:
        text += "\n" + word("left_out_bytes", language, count=stream.dropped_bytes)
    return text
