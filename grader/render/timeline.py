"""What happened in a run, in order of virtual time: the output of `grader run`."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from grader.contracts.grading import WorldRequest
from grader.contracts.outcome import RunOutcome
from grader.contracts.text import Language
from grader.contracts.trajectory import COMMAND_LIFE_NS, Command, Trajectory
from grader.geometry.path import driven_path
from grader.messages import quantity
from grader.messages.details import explained
from grader.render.escape import visible, visible_line
from grader.render.labels import status_word, wall_word, word

MOST_EVENTS = 200
_NANO = 1e-9
_TIME_DECIMALS = 3  # as the log lines of ROS show
_SAME_COMMAND = 1e-9
_UPDATE_NS = 16_000_000
_LEAST_M, _LEAST_DEG = 0.001, 0.1
_LEVEL_STYLE = {30: "yellow", 40: "red", 50: "bold red"}


@dataclass(frozen=True, slots=True)
class TimelineEntry:
    """One line of the timeline; `text` is already safe to show. Equal lines in a row may become one."""

    t_ns: int
    text: str
    style: str = ""
    may_repeat: bool = False


def render_timeline(
    outcome: RunOutcome,
    trajectory: Trajectory | None,
    *,
    language: Language,
    requests: Sequence[WorldRequest] = (),
) -> RenderableType:
    """Return log records, runs of equal commands, calls, jumps, contacts and the end as one table.

    The middle of a timeline longer than `MOST_EVENTS` is left out.
    """
    events = sorted(_events(outcome, trajectory, requests, language), key=lambda each: each.t_ns)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(word("time", language), justify="right", no_wrap=True)
    table.add_column(word("event", language), overflow="fold")
    for event in _bounded(_merged(events, language), language):
        table.add_row(f"{event.t_ns * _NANO:.{_TIME_DECIMALS}f} s", Text(event.text, style=event.style))
    return table


def _events(
    outcome: RunOutcome,
    trajectory: Trajectory | None,
    requests: Sequence[WorldRequest],
    language: Language,
) -> Iterator[TimelineEntry]:
    for record in outcome.logs:
        line = f"[{record.level_name}] [{visible_line(record.name, 80)}]: {visible_line(record.message, 500)}"
        yield TimelineEntry(record.t_ns, line, _LEVEL_STYLE.get(record.level, ""), may_repeat=True)
    for request in requests:
        call = f"{visible_line(request.service, 120)}({visible_line(request.values, 200)})"
        yield TimelineEntry(request.t_ns, word("called", language, call=call), "magenta")
    if trajectory is not None:
        yield from _sayings(trajectory, language)
        yield from _command_runs(trajectory.at_once(), language)
        yield from _waits(outcome, trajectory, language)
        yield from _jumps(trajectory, requests, language)
        for contact in trajectory.contacts:
            wall = wall_word(contact.wall, language) or visible_line(contact.wall, 20)
            yield TimelineEntry(contact.start_ns, word("contact", language, wall=wall), "yellow")
    yield TimelineEntry(outcome.duration_ns, _end(outcome, language), "bold")


def _sayings(track: Trajectory, language: Language) -> Iterator[TimelineEntry]:
    """Yield what was said: to the script with an arrow to the right, by it with one to the left."""
    for saying in track.sayings:
        arrow = "←" if saying.way in ("out", "ask") else "→"
        text = f"{arrow} {visible_line(saying.name, 80)}  {visible_line(saying.text, 200)}"
        if saying.way in ("call", "ask"):
            took_ns = None if saying.until_ns is None else saying.until_ns - saying.t_ns
            told = word("no_answer", language)
            if took_ns is not None:
                told = word(
                    "answered_after", language, time=quantity.number(took_ns * _NANO, "s", _TIME_DECIMALS)
                )
            text += f"  {told}"
        yield TimelineEntry(
            saying.t_ns, text, "green" if arrow == "←" else "blue", may_repeat=saying.way == "out"
        )


def _waits(outcome: RunOutcome, driven: Trajectory, language: Language) -> Iterator[TimelineEntry]:
    """Yield when what the turtle drove first differs from what was commanded, and by how much it may."""
    for note in outcome.notes:
        if note.code == "commands_wait" and driven.commanded is not None:
            rate, _, seconds = note.text.partition("|")
            text = word("waits", language, rate=rate, time=quantity.number(float(seconds), "s", 2))
            yield TimelineEntry(_parted_ns(driven, driven.commanded), text, "yellow")


def _parted_ns(one: Trajectory, other: Trajectory) -> int:
    """Return when two motions from one place first differ."""
    both = min(len(one), len(other))
    columns = [(each.t_ns, each.x_m, each.y_m, each.heading_rad) for each in (one, other)]
    differ = np.any([a[:both] != b[:both] for a, b in zip(*columns, strict=True)], axis=0)
    return int(one.t_ns[differ.argmax() if differ.any() else both - 1])


def _command_runs(track: Trajectory, language: Language) -> Iterator[TimelineEntry]:
    """Yield one event for each stretch of equal commands, with what they made the car do until it ended."""
    path = driven_path(track.x_m, track.y_m, track.heading_rad, track.jumps)
    commands, first = track.commands, 0
    for i in range(1, len(commands) + 1):
        if i < len(commands) and _equal(commands[i], commands[first]):
            continue
        command, dropped_ns = commands[first], commands[i - 1].t_ns + COMMAND_LIFE_NS
        next_ns = commands[i].t_ns if i < len(commands) else track.end_ns
        until_ns = min(dropped_ns, next_ns)
        # Obeyed at once, a command moves the car from the next update on: it begins with the sample before.
        start, end = (int(np.searchsorted(track.t_ns, at, "right")) - 1 for at in (command.t_ns, until_ns))
        moved_m = float(path.signed_m[end] - path.signed_m[start])
        turned_deg = math.degrees(float(path.heading_rad[end] - path.heading_rad[start]))
        parts = [_commanded(command, i - first, language)]
        if command.v_mps or command.w_radps:
            held = quantity.number((until_ns - command.t_ns) * _NANO, "s", _TIME_DECIMALS)
            parts += [word("held", language, time=held), *_motion(moved_m, turned_deg, language)]
            parts += [word("dropped", language)] if dropped_ns < next_ns else []
        yield TimelineEntry(command.t_ns, word("comma", language).join(parts), "cyan")
        first = i


def _equal(one: Command, other: Command) -> bool:
    return abs(one.v_mps - other.v_mps) < _SAME_COMMAND and abs(one.w_radps - other.w_radps) < _SAME_COMMAND


def _commanded(command: Command, count: int, language: Language) -> str:
    v, w = quantity.number(command.v_mps, "m/s"), quantity.number(command.w_radps, "rad/s")
    text = f"{word('command', language)} v = {v}, ω = {w}"
    return f"{text}  {word('times', language, count=count)}" if count > 1 else text


def _motion(moved_m: float, turned_deg: float, language: Language) -> Iterator[str]:
    if abs(moved_m) >= _LEAST_M:
        key = "moved_ahead" if moved_m > 0 else "moved_back"
        yield word(key, language, distance=quantity.number(abs(moved_m), "m", 3))
    if abs(turned_deg) >= _LEAST_DEG:
        key = "turned_left" if turned_deg > 0 else "turned_right"
        yield word(key, language, angle=quantity.number(abs(turned_deg), "deg"))


def _jumps(
    track: Trajectory, requests: Sequence[WorldRequest], language: Language
) -> Iterator[TimelineEntry]:
    """Yield where a teleport or reset put the car, behind the call that did it."""
    for i in track.jumps:
        taken_ns = int(track.t_ns[i])  # up; the update that puts it down is the next one
        at_ns = max(
            [taken_ns, *(request.t_ns for request in requests if 0 <= request.t_ns - taken_ns <= _UPDATE_NS)]
        )
        heading_deg = math.degrees(math.remainder(float(track.heading_rad[i]), math.tau))
        x, y = (quantity.number(float(place[i]), "m", 3) for place in (track.x_m, track.y_m))
        text = word("jumped", language, x=x, y=y, heading=quantity.number(heading_deg, "deg"))
        yield TimelineEntry(at_ns, text, "magenta")


def _merged(events: list[TimelineEntry], language: Language) -> list[TimelineEntry]:
    """Return the events with equal lines in a row as one that says how many there were, and until when."""
    merged: list[TimelineEntry] = []
    count = 0
    for i, event in enumerate(events):
        count += 1
        following = events[i + 1] if i + 1 < len(events) else None
        if following is not None and event.may_repeat and replace(following, t_ns=event.t_ns) == event:
            continue
        first = events[i + 1 - count]
        if count > 1:
            last = f"{event.t_ns * _NANO:.{_TIME_DECIMALS}f} s"
            text = f"{first.text}  {word('until', language, count=count, time=last)}"
            first = replace(first, text=text)
        merged.append(first)
        count = 0
    return merged


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
