"""Notes on a run whose motion as driven differs from that as commanded; they cost nothing."""

import math

import numpy as np

from grader.checks.drive import path_of
from grader.contracts.outcome import Note
from grader.contracts.rubric import Unit
from grader.contracts.scoring import Run
from grader.contracts.trajectory import Trajectory
from grader.geometry import exact
from grader.geometry.path import segment
from grader.messages.quantity import number


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
