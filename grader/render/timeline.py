"""What happened in a run, in order of virtual time: the output of `grader run`."""

from collections.abc import Iterator
from dataclasses import dataclass

from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from grader.contracts.outcome import RunOutcome
from grader.contracts.text import Language
from grader.contracts.trajectory import Command, Trajectory
from grader.messages import quantity
from grader.messages.details import explained
from grader.render.escape import visible, visible_line
from grader.render.labels import status_word, wall_word, word

MOST_EVENTS = 200
_NANO = 1e-9
_TIME_DECIMALS = 3  # as the log lines of ROS show
_SAME_COMMAND = 1e-9
_LEVEL_STYLE = {30: "yellow", 40: "red", 50: "bold red"}


@dataclass(frozen=True, slots=True)
class TimelineEntry:
    """One line of the timeline; `text` is already safe to show."""

    t_ns: int
    text: str
    style: str = ""


def render_timeline(
    outcome: RunOutcome, trajectory: Trajectory | None, *, language: Language
) -> RenderableType:
    """Return log records, runs of equal commands, contacts and the end as one table.

    The middle of a timeline longer than `MOST_EVENTS` is left out.
    """
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(word("time", language), justify="right", no_wrap=True)
    table.add_column(word("event", language), overflow="fold")
    for event in _bounded(sorted(_events(outcome, trajectory, language), key=lambda e: e.t_ns), language):
        table.add_row(f"{event.t_ns * _NANO:.{_TIME_DECIMALS}f} s", Text(event.text, style=event.style))
    return table


def _events(
    outcome: RunOutcome, trajectory: Trajectory | None, language: Language
) -> Iterator[TimelineEntry]:
    for record in outcome.logs:
        line = f"[{record.level_name}] [{visible_line(record.name, 80)}]: {visible_line(record.message, 500)}"
        yield TimelineEntry(record.t_ns, line, _LEVEL_STYLE.get(record.level, ""))
    if trajectory is not None:
        yield from _command_runs(trajectory.commands, language)
        for contact in trajectory.contacts:
            wall = wall_word(contact.wall, language) or visible_line(contact.wall, 20)
            yield TimelineEntry(contact.start_ns, word("contact", language, wall=wall), "yellow")
    yield TimelineEntry(outcome.duration_ns, _end(outcome, language), "bold")


def _command_runs(commands: tuple[Command, ...], language: Language) -> Iterator[TimelineEntry]:
    """Yield one event for each stretch of equal commands."""
    first = 0
    for i in range(1, len(commands) + 1):
        if i == len(commands) or not _equal(commands[i], commands[first]):
            yield _command_run(commands[first], commands[i - 1].t_ns, i - first, language)
            first = i


def _equal(one: Command, other: Command) -> bool:
    return abs(one.v_mps - other.v_mps) < _SAME_COMMAND and abs(one.w_radps - other.w_radps) < _SAME_COMMAND


def _command_run(command: Command, last_ns: int, count: int, language: Language) -> TimelineEntry:
    v, w = quantity.number(command.v_mps, "m/s"), quantity.number(command.w_radps, "rad/s")
    text = f"{word('command', language)} v = {v}, ω = {w}"
    if count > 1:
        time = quantity.number((last_ns - command.t_ns) * _NANO, "s", _TIME_DECIMALS)
        text += "  " + word("repeated", language, count=count, time=time)
    return TimelineEntry(command.t_ns, text, "cyan")


def _end(outcome: RunOutcome, language: Language) -> str:
    text = f"{word('end', language)}: {status_word(outcome.status, language)}"
    if outcome.error is not None:
        text += f" - {visible_line(outcome.error.type, 80)}: {visible_line(outcome.error.message, 300)}"
    detail = explained(outcome.status, outcome.detail).get(language)
    return f"{text} - {visible(detail)}" if detail else text


def _bounded(events: list[TimelineEntry], language: Language) -> list[TimelineEntry]:
    left_out = len(events) - MOST_EVENTS
    if left_out <= 1:
        return events
    half = MOST_EVENTS // 2
    gap = TimelineEntry(events[half].t_ns, word("left_out_lines", language, count=left_out), "dim")
    return [*events[:half], gap, *events[-half:]]
