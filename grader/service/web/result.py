"""A grading as its page shows it: the words of `grader.render`, in one language, ready for a template.

Everything here is still raw text; the templates escape it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from operator import attrgetter
from typing import Any

from grader.contracts.assignment import Assignment
from grader.contracts.figure import FigureSketch, SketchSide
from grader.contracts.outcome import (
    SHOWN_CHARACTERS,
    SHOWN_LOGS,
    Blame,
    LogRecord,
    RunOutcome,
    Stream,
    StudentError,
)
from grader.contracts.report import CaseRun, GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus, RubricItem, summed
from grader.contracts.text import Language
from grader.messages import on_page, quantity
from grader.messages.details import explained
from grader.render.captured import without_logs
from grader.render.labels import (
    ITEM_MARK,
    cleanup_sentence,
    item_status_word,
    note_sentence,
    status_word,
    word,
)

_REPLAY_WORDS = (
    "play",
    "pause",
    "time",
    "still",
    "plan",
    "v",
    "w",
    "turned",
    "heading",
    "command",
    "times",
    "lasting",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ItemLine:
    """One rubric item, of one case where there are several. `mark` tells the status without colour."""

    id: str
    case: str
    title: str
    status: str
    mark: str
    status_text: str
    earned: str
    points: str
    measured: str
    wanted: str
    message: str
    hint: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ItemGroup:
    """One rubric item in all cases: its points together, and a line for each case."""

    id: str
    title: str
    status: str
    mark: str
    status_text: str
    earned: str
    points: str
    lines: tuple[ItemLine, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunError:
    """What ended the script, and in which runs."""

    error: StudentError
    cases: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLine:
    """A log message, and how often it came in a row; the time is the first one's, in virtual seconds."""

    seconds: str
    level: str
    severe: bool
    name: str
    message: str
    times: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamText:
    """Captured output; `dropped` counts what is not shown."""

    text: str
    dropped: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RunPart:
    """What happened in one run of the script."""

    case: str
    title: str
    ended: str
    normal: bool
    seconds: str
    error: StudentError | None
    detail: str
    notes: tuple[str, ...]
    logs: tuple[LogLine, ...]
    logs_dropped: int
    stdout: StreamText
    stderr: StreamText


@dataclass(frozen=True, slots=True, kw_only=True)
class FigurePart:
    """A measured part of the driven figure: a side, a corner or the gap."""

    name: str
    value: str
    ok: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultPage:
    """A whole grading. `pending`: it has no score yet, because something waits for a person."""

    score: str
    max_score: str
    percent: int
    full: bool
    pending: bool
    status: str
    normal: bool
    summary: str
    hint: str
    items: tuple[ItemLine, ...]
    groups: tuple[ItemGroup, ...]
    runs: tuple[RunPart, ...]
    errors: tuple[RunError, ...]

    @property
    def notes(self) -> tuple[str, ...]:
        """What the runs noted that costs no points, each once."""
        return tuple(dict.fromkeys(note for run in self.runs for note in run.notes))


def result_page(report: GradeReport, assignment: Assignment | None, language: Language) -> ResultPage:
    """Return `report` in `language`; `assignment` names the cases, if it is still published."""
    share = 0.0 if report.score is None or report.max_score <= 0.0 else report.score / report.max_score
    runs = tuple(_run(run, assignment, language) for run in report.runs)
    titles = {part.case: part.title for part in runs} if len(runs) > 1 else {}
    return ResultPage(
        score=word("not_yet", language) if report.score is None else quantity.points(report.score),
        max_score=quantity.points(report.max_score),
        percent=round(100.0 * share),
        full=share >= 1.0,
        pending=report.score is None,
        status=status_word(report.status, language),
        normal=report.status in (GradeStatus.GRADED, GradeStatus.NEEDS_MANUAL),
        summary=_waiting(report, language) if report.score is None else report.summary.get(language),
        hint=report.hint.get(language),
        items=tuple(item_line(item, language) for item in report.items),
        groups=_groups(report.items, titles, language),
        runs=runs,
        errors=_errors(runs),
    )


def _waiting(report: GradeReport, language: Language) -> str:
    """Return how much a person has still to judge, and what the rest has earned: that is no score yet."""
    known = [item for item in report.items if item.status is not ItemStatus.NEEDS_MANUAL]
    told = on_page(language, "result.waiting", count=len(report.items) - len(known))
    if not known:
        return told
    earned, most = (
        quantity.points(summed(getattr(one, name) for one in known)) for name in ("earned", "points")
    )
    return told + on_page(language, "result.so_far", earned=earned, points=most)


def _groups(
    items: Sequence[RubricItem], titles: Mapping[str, str], language: Language
) -> tuple[ItemGroup, ...]:
    """Return the items with those of several cases, which share their points, together."""
    together: dict[str, list[RubricItem]] = {}
    for item in items:
        together.setdefault(item.id.rpartition("/")[2] if titles else item.id, []).append(item)
    return tuple(_group(id_, some, titles, language) for id_, some in together.items())


def _group(
    item_id: str, items: Sequence[RubricItem], titles: Mapping[str, str], language: Language
) -> ItemGroup:
    states = {item.status for item in items}
    status = states.pop() if len(states) == 1 else ItemStatus.PARTIAL
    status = ItemStatus.NEEDS_MANUAL if ItemStatus.NEEDS_MANUAL in states else status
    waits = status is ItemStatus.NEEDS_MANUAL
    return ItemGroup(
        id=item_id,
        title=items[0].title.get(language),
        status=status.value,
        mark=ITEM_MARK[status].replace("-", "–"),
        status_text=item_status_word(status, language),
        earned=quantity.NOTHING if waits else quantity.points(summed(item.earned for item in items)),
        points=quantity.points(summed(item.points for item in items)),
        lines=tuple(item_line(item, language, titles.get(item.id.rpartition("/")[0], "")) for item in items),
    )


def _errors(runs: Sequence[RunPart]) -> tuple[RunError, ...]:
    """Return what ended the script, the same in several runs once."""
    found: dict[StudentError, list[str]] = {}
    for part in runs:
        if part.error is not None:
            found.setdefault(part.error, []).append(part.title)
    return tuple(RunError(error=error, cases=tuple(cases)) for error, cases in found.items())


def item_line(item: RubricItem, language: Language, case: str = "") -> ItemLine:
    """Return one rubric item, in the case of that title."""
    return ItemLine(
        id=item.id,
        case=case,
        title=item.title.get(language),
        status=item.status.value,
        mark=ITEM_MARK[item.status].replace("-", "–"),
        status_text=item_status_word(item.status, language),
        earned=quantity.NOTHING if item.status is ItemStatus.NEEDS_MANUAL else quantity.points(item.earned),
        points=quantity.points(item.points),
        measured=quantity.measured(item, language),
        wanted=quantity.wanted(item, language),
        message=item.message.get(language),
        hint=item.hint.get(language),
    )


def figure_parts(figure: FigureSketch, names: dict[str, str]) -> tuple[FigurePart, ...]:
    """Return sides, corners and gap in the order driven, then places; `names` are the words for them."""
    parts = []
    for number, side in enumerate(figure.sides, start=1):
        parts.append(FigurePart(name=f"{names['side']} {number}", value=_length(side), ok=side.ok))
        if number <= len(figure.corners):
            corner = figure.corners[number - 1]
            angle = quantity.signed(corner.angle_deg, "deg")
            parts.append(FigurePart(name=f"{names['corner']} {number}", value=angle, ok=corner.ok))
    if figure.gap is not None:
        parts.append(FigurePart(name=names["gap"], value=_length(figure.gap), ok=figure.gap.ok))
    for region in figure.regions:
        kind, verdict = ("avoid", "clear") if region.avoid else ("goal", "reached")
        name = names[kind] if region.avoid else f"{names[kind]} {region.text.zh}"
        value = names[verdict if region.ok else f"not_{verdict}"]
        parts.append(FigurePart(name=name, value=value, ok=region.ok))
    return tuple(parts)


def _length(side: SketchSide) -> str:
    return quantity.number(side.length_m, "m")


def _run(run: CaseRun, assignment: Assignment | None, language: Language) -> RunPart:
    outcome = run.outcome
    cases = () if assignment is None else assignment.cases
    title = next((case.title.get(language) for case in cases if case.id == run.case), "")
    return RunPart(
        case=run.case,
        title=title or run.case,
        ended=status_word(outcome.status, language),
        normal=outcome.blame is Blame.NOBODY,
        seconds=quantity.number(outcome.duration_ns * 1e-9, "1", 1),
        error=outcome.error,
        detail=explained(outcome.status, outcome.detail).get(language),
        notes=_notes(outcome, language),
        logs=_logs(outcome.logs[:SHOWN_LOGS]),
        logs_dropped=outcome.logs_dropped + max(0, len(outcome.logs) - SHOWN_LOGS),
        stdout=stream_text(without_logs(outcome.stdout, outcome.logs[:SHOWN_LOGS])),
        stderr=stream_text(without_logs(outcome.stderr, outcome.logs[:SHOWN_LOGS])),
    )


def _notes(outcome: RunOutcome, language: Language) -> tuple[str, ...]:
    """Return what is worth knowing and costs nothing, each sentence once."""
    sentences = [note_sentence(note, language) for note in outcome.notes]
    if outcome.nonfinite_commands:
        sentences.append(word("nonfinite", language, count=outcome.nonfinite_commands))
    if outcome.cleanup_error is not None:
        error = f"{outcome.cleanup_error.type}: {outcome.cleanup_error.message}"
        sentences.append(cleanup_sentence(outcome.cleanup_error, error, language))
    return tuple(dict.fromkeys(sentences))


def _logs(records: Sequence[LogRecord]) -> tuple[LogLine, ...]:
    lines = []
    for (level, name, message), same in groupby(records, key=attrgetter("level_name", "name", "message")):
        first, *others = same
        lines.append(
            LogLine(
                seconds=f"{first.t_ns * 1e-9:.3f}",
                level=level,
                severe=first.level >= 40,
                name=name,
                message=message,
                times=1 + len(others),
            )
        )
    return tuple(lines)


def stream_text(stream: Stream) -> StreamText:
    """Return captured output as far as a page shows it."""
    left_out = max(0, len(stream.text) - SHOWN_CHARACTERS)
    return StreamText(text=stream.text[:SHOWN_CHARACTERS], dropped=stream.dropped_bytes + left_out)


def replay_words(language: Language) -> dict[str, str]:
    """Return what the script of the replay says."""
    return {name: on_page(language, f"replay.{name}") for name in _REPLAY_WORDS}


def figure_document(figure: FigureSketch, language: Language) -> dict[str, Any]:
    """Return a figure as plain data with its remarks in `language`."""
    labels = [
        {"at_m": label.at_m, "text": label.text.get(language), "ok": label.ok} for label in figure.labels
    ]
    plain = asdict(figure)
    regions = [
        {**shown, "text": one.text.get(language)}
        for shown, one in zip(plain["regions"], figure.regions, strict=True)
    ]
    return {**plain, "labels": labels, "regions": regions}
