"""The path that an assignment's solution drives, stored in a file beside it, for ``reference: solution``."""

import hashlib
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Final

from grader.catalog.files import REFERENCE, SOLUTION
from grader.contracts.assignment import Assignment

POINTS: Final = 400
"""How many points are recorded, at equal distances along the way."""

Trace = tuple[tuple[float, float], ...]


def with_reference(assignment: Assignment, folder: Path) -> Assignment:
    """Return the assignment with its solution's recorded path, if it asks for one and one is recorded."""
    if assignment.path is None or not assignment.path.by_solution:
        return assignment
    return replace(assignment, path=replace(assignment.path, trace=_recorded(folder)))


def record(folder: Path, trace: Trace) -> None:
    """Write down what the solution in `folder` drives.

    Raises OSError: the solution cannot be read, or the record not be written.
    """
    document = {"solution_sha256": _digest(folder), "points": trace}
    (folder / REFERENCE).write_text(json.dumps(document) + "\n", encoding="utf-8")


def _recorded(folder: Path) -> Trace:
    """Return the recorded points; none where there are none, or of another solution, or broken ones."""
    try:
        document = json.loads((folder / REFERENCE).read_bytes())
        if document["solution_sha256"] != _digest(folder):
            return ()
        trace = tuple((float(x), float(y)) for x, y in document["points"][:POINTS])
    except (OSError, ValueError, KeyError, TypeError):
        return ()
    return trace if len(trace) > 1 and all(map(math.isfinite, sum(trace, ()))) else ()


def _digest(folder: Path) -> str:
    return hashlib.sha256((folder / SOLUTION).read_bytes()).hexdigest()
