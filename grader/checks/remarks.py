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
from grader.contracts.outcome import Note
from grader.contracts.rubric import Unit
from grader.contracts.scoring import Run
from grader.contracts.trajectory import Trajectory
from grader.geometry import exact
from grader.geometry.path import segment
from grader.messages.quantity import number

_PLACEHOLDER: Final = re.compile(r"\{([A-Za-z_][\w.]*)(?:[:!][^{}]*)?\}")
_SLOW_S: Final = 2.0
_LONGEST: Final = 50_000  # characters that are searched
_TOO_FAST_MPS: Final = 5.0


def remarks(run: Run) -> tuple[Note, ...]:
    """Return the notes for a run that lost no points."""
    looks = (_braces, _slow_timer, _faster)
    return tuple(Note(code=code, text=text) for look in looks for code, text in look(run))


def notes_of_both(run: Run, *, as_commanded: bool) -> tuple[Note, ...]:
    """Return the notes on a run as driven and as commanded: which counts, how far both go, their mean corners.

    Corners are told where both motions have as many, two at least, and the means differ as they are written.
    """
    both = (run.trajectory, run.trajectory.at_once())
    told = "|".join(number(value, unit) for each in both for value, unit in _extent(each))
    counted = Note(code="counted_commanded" if as_commanded else "counted_driven", text=told)
    driven_deg, commanded_deg = map(_corners_deg, both)
    if len(driven_deg) != len(commanded_deg) or len(driven_deg) < 2:
        return (counted,)
    means = [number(exact.mean(corners), "deg") for corners in (driven_deg, commanded_deg)]
    return (
        (counted, Note(code="corners_at_home", text="|".join(means))) if len(set(means)) > 1 else (counted,)
    )


def _corners_deg(motion: Trajectory) -> list[float]:
    """Return how far the turns between the straights of a motion turn, to either side."""
    turns = segment(path_of(motion, len(motion))).turns[1:-1]
    return [math.degrees(abs(turn.angle_rad)) for turn in turns if turn is not None]


def _extent(motion: Trajectory) -> tuple[tuple[float, Unit], ...]:
    """Return how far a motion goes, and how far it turns, back and forth added."""
    path = path_of(motion, len(motion))
    gone, turned = (float(np.abs(np.diff(values)).sum()) for values in (path.signed_m, path.heading_rad))
    return (gone, "m"), (math.degrees(turned), "deg")


def _braces(run: Run) -> Iterator[tuple[str, str]]:
    """Recognise a message in which ``{name}`` stands as it is written, though the script sets that name."""
    said = [*(record.message for record in run.outcome.logs[:50]), run.outcome.stdout.text[:2_000]]
    for found in _PLACEHOLDER.finditer("\n".join(said)):
        written, name = found[0], re.escape(found[1])
        lines = [n for n, line in enumerate(run.source.split("\n"), start=1) if written in line]
        if lines and re.search(rf"(?<![\w.{{]){name}[ \t]*=(?!=)|\bfor {name} in\b", run.source[:_LONGEST]):
            yield "braces", f"{lines[0]}|{written}"
            return


def _slow_timer(run: Run) -> Iterator[tuple[str, str]]:
    """Recognise motions so far apart that turtlesim stops the car between each two."""
    moves = [command.t_ns for command in run.trajectory.commands if command.v_mps or command.w_radps]
    gaps_s = {round((after - before) / 1e9, 1) for before, after in itertools.pairwise(moves)}
    if len(moves) > 2 and len(gaps_s) == 1 and min(gaps_s) >= _SLOW_S:
        yield "slow_timer", f"{gaps_s.pop():g}"


def _faster(run: Run) -> Iterator[tuple[str, str]]:
    """Recognise a speed that grows with every message, and never stops growing."""
    speeds = [abs(command.v_mps) for command in run.trajectory.commands]
    grows = len(speeds) > 20 and all(one < other for one, other in itertools.pairwise(speeds))
    if grows and speeds[-1] > _TOO_FAST_MPS:
        yield "faster", f"{speeds[-1]:.1f}"
