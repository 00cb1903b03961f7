"""What is worth saying of a script that works here, and yet is not what its author meant.

Remarks are notes: they cost nothing, and `note.<code>` says what to change. Each is tied to what happened.
"""

import itertools
import math
import re
from collections.abc import Iterator
from typing import Final

import numpy as np

from grader.checks.drive import path_of
from grader.contracts.outcome import Note, RunStatus
from grader.contracts.rubric import Unit
from grader.contracts.scoring import Run
from grader.contracts.trajectory import COMMAND_LIFE_NS, Trajectory
from grader.messages.arithmetic import value_of
from grader.messages.quantity import number
from grader.messages.script import ScriptText

_PLACEHOLDER: Final = re.compile(r"\{([A-Za-z_][\w.]*)(?:[:!][^{}]*)?\}")
_AMOUNT: Final = r"(?i)time|elapsed|dur|sec|dist|angle|theta|yaw|turned|^[twxy]$"
_TOO_FAST_MPS: Final = 5.0
_TURNED_RAD: Final = 13.0  # two turns


def remarks(run: Run) -> tuple[Note, ...]:
    """Return the notes for a run that lost no points."""
    script = ScriptText(run.source)
    if not script.is_short:
        return ()
    looks = (_endless, _braces, _slow_timer, _faster)
    return tuple(Note(code=code, text=text) for look in looks for code, text in look(run, script))


def counted_note(run: Run, *, as_commanded: bool) -> Note:
    """Return the note that says which motion counts, and how far both go."""
    both = (run.trajectory, run.trajectory.at_once())
    told = "|".join(number(value, unit) for each in both for value, unit in _extent(each))
    return Note(code="counted_commanded" if as_commanded else "counted_driven", text=told)


def _extent(motion: Trajectory) -> tuple[tuple[float, Unit], ...]:
    """Return how far a motion goes, and how far it turns, back and forth added."""
    path = path_of(motion, len(motion))
    gone, turned = (float(np.abs(np.diff(each)).sum()) for each in (path.signed_m, path.heading_rad))
    return (gone, "m"), (math.degrees(turned), "deg")


def _endless(run: Run, script: ScriptText) -> Iterator[tuple[str, str]]:
    """Recognise a loop that never ends: its counter never changes, or counts radians up to degrees."""
    if (found := unchanged_counter(run, script)) is not None:
        yield "counter_unchanged", f"{found[0]}|{found[1]}"
        return
    turned_rad = float(abs(run.trajectory.heading_rad[-1] - run.trajectory.heading_rad[0]))
    if run.outcome.status is not RunStatus.INTERRUPTED or turned_rad < _TURNED_RAD:
        return
    for line in script.lines_with(r"^[ \t]*while .*[<>]=? ?(90|180|360)(\.0*)? ?:"):
        block = "\n".join(script.block(line)[1:])
        if not re.search(r"\bdegrees\(|180", block):
            yield "counts_degrees", str(line)
            return


def _braces(run: Run, script: ScriptText) -> Iterator[tuple[str, str]]:
    """Recognise a message in which ``{name}`` stands as it is written."""
    said = [*(record.message for record in run.outcome.logs[:50]), run.outcome.stdout.text[:2_000]]
    for found in _PLACEHOLDER.finditer("\n".join(said)):
        written = found[0]
        lines = [n for n, line in enumerate(run.source.split("\n"), start=1) if written in line]
        known = script.lines_with(rf"\b{re.escape(found[1])}\b(?! ?\()")
        if lines and known:
            yield "braces", f"{lines[0]}|{written}"
            return


def _slow_timer(run: Run, script: ScriptText) -> Iterator[tuple[str, str]]:
    """Recognise a timer so slow that turtlesim stops the car between two ticks."""
    for line in script.lines_with(r"\bcreate_timer\("):
        found = re.search(r"create_timer\( ?([^,()]+),", script.lines[line - 1])
        period_s = value_of(found[1].strip(), script) if found else None
        if period_s is None or period_s < 2.0:
            continue
        moves = [one.t_ns for one in run.trajectory.commands if one.v_mps or one.w_radps]
        gaps = {round((after - before) / 1e9, 1) for before, after in itertools.pairwise(moves)}
        if moves and gaps <= {round(period_s, 1)} and period_s * 1e9 > COMMAND_LIFE_NS:
            yield "slow_timer", f"{line}|{period_s:g}"
            return


def _faster(run: Run, script: ScriptText) -> Iterator[tuple[str, str]]:
    """Recognise a speed that grows with every message, and never stops growing."""
    lines = script.lines_with(r"\.linear\.x ?[-+]=|\.linear\.x ?= ?[\w.]*\.linear\.x ?[-+]")
    if not lines:
        return
    speeds = [abs(one.v_mps) for one in run.trajectory.commands]
    grows = len(speeds) > 20 and all(one < other for one, other in itertools.pairwise(speeds))
    if grows and speeds[-1] > _TOO_FAST_MPS:
        yield "faster", f"{lines[0]}|{speeds[-1]:.1f}"


def unchanged_counter(run: Run, script: ScriptText) -> tuple[int, str] | None:
    """Return line and name of a counter that its ``while`` never changes, in a script that never ended."""
    if run.outcome.status is not RunStatus.INTERRUPTED:
        return None
    bounds = r"[\w.]+(?: ?[*/+-] ?[\w.]+)*"
    for line, found in script.matches(rf"^[ \t]*while \(?([^\W\d]\w*) ?(?:<=?|(!=)) ?({bounds})\)? ?:"):
        if re.search(_AMOUNT, found[1]):
            continue  # a time or a way grows by less than 1
        name, unlike, bound = found.groups()
        if unlike and not _starts_below(name, bound, script):
            continue  # it may have to count down
        if script.lines_with(rf"\b(global|nonlocal)\b.*\b{name}\b"):
            continue
        block = "\n".join(script.block(line)[1:])
        names = "|".join([name, *map(re.escape, re.findall(r"[A-Za-z_][\w.]*", bound))])
        changed = rf"(?<![\w.])({names})\b ?(,[^=\n]*|[-+*/%]|//)?=(?!=)|\b(for|as) [\w, ]*\b({names})\b|:="
        if not re.search(rf"{changed}|\b(break|return|raise|exit|shutdown|quit)\b", block):
            return line, name
    return None


def _starts_below(name: str, bound: str, script: ScriptText) -> bool:
    start, end = value_of(name, script), value_of(bound, script)
    return start is not None and end is not None and start < end
