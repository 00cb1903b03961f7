"""One line for each script of the corpus of reports: its score, and hashes of what came of it.

The corpus is everything that the tests grade: the files of all assignments, the scripts of hints, beginners and
styles, the generated corpus, and drives near the edges of bands (`gradings` lists it). Two tables say which scores
moved between two versions of the grader; `matrix` says whether processors, libraries and Pythons give
the same bytes.

    python -m tests.digest --save before.tsv
    python -m tests.digest --compare before.tsv --only square
    python -m tests.digest --renew                            after changes of reports that are meant
    python -m tests.digest.matrix --every 10
"""

import hashlib
from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue
from typing import NamedTuple

from grader.contracts.errors import GraderError
from grader.contracts.grading import Grader
from grader.contracts.record import canonical
from grader.contracts.report import GradeReport
from grader.contracts.text import EMPTY
from grader.grading.slot import Slot, SlotConfig
from tests.digest.gradings import Grading

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "reports.tsv"
"""The committed sample of the table, each `SAMPLED`-th line, and the hash of the whole table."""

SAMPLED = 40
WHOLE = "all"

HASHES = ("marks", "trajectory", "report", "unhinted")
_DIGITS = 12
_REFUSED = "refused"


class Line(NamedTuple):
    """What came of one script.

    Attributes:
        score: as the report has it; ``-`` where a person has still to grade, ``refused`` where nothing was graded.
        marks: hash of status, score and the points of each item. trajectory: hash of all runs' trajectories.
        report: hash of the whole report. unhinted: hash of the report without hints and mistakes.
    """

    id: str
    score: str
    marks: str
    trajectory: str
    report: str
    unhinted: str


def lines(grader: Grader, gradings: Iterable[Grading]) -> list[Line]:
    """Grade one script after the other."""
    return [_line(grader, grading) for grading in gradings]


def lines_of_slots(gradings: Iterable[Grading], slots: int, tell: Callable[[int], None]) -> list[Line]:
    """Grade everything with `slots` warm slots; tell how many are done now and then."""
    idle: SimpleQueue[Slot] = SimpleQueue()
    ready = [Slot(SlotConfig(niceness=10)) for _ in range(slots)]
    for slot in ready:
        idle.put(slot)

    def graded(grading: Grading) -> Line:
        slot = idle.get()
        try:
            return _line(slot, grading)
        finally:
            idle.put(slot)

    try:
        with ThreadPoolExecutor(slots) as threads:
            table = []
            for line in threads.map(graded, gradings):
                table.append(line)
                if len(table) % 100 == 0:
                    tell(len(table))
            return table
    finally:
        for slot in ready:
            slot.close()


def compared(before: Mapping[str, Line], after: Iterable[Line]) -> Iterator[str]:
    """Yield a row for each score that moved, and how many hashes of each kind differ."""
    differing: Counter[str] = Counter()
    new = 0
    for line in after:
        earlier = before.get(line.id)
        if earlier is None:
            new += 1
            continue
        if line.score != earlier.score:
            yield f"{line.id}\t{earlier.score} -> {line.score}"
        differing.update(kind for kind in HASHES if getattr(line, kind) != getattr(earlier, kind))
    yield ", ".join(f"{kind}: {differing[kind]} differ" for kind in HASHES) + f"; {new} new"


def read(path: Path) -> dict[str, Line]:
    """Return the lines of a saved table by id."""
    rows = [Line(*row.split("\t")) for row in path.read_text("utf-8").splitlines()]
    return {row.id: row for row in rows}


def renewed(table: list[Line]) -> str:
    """Return the committed sample of the portable table of the whole corpus."""
    whole = Line(WHOLE, str(len(table)), *[_hash(written(table).encode())] * len(HASHES))
    return written([*table[::SAMPLED], whole])


def portable(table: Iterable[Line], replays: Container[str]) -> list[Line]:
    """Return what of a table is the same on every machine: of a replayed PyBullet world the marks alone."""
    return [Line(*line[:3], "-", "-", "-") if line.id in replays else line for line in table]


def digest(table: Iterable[Line]) -> str:
    """Return one hash of a table."""
    return _hash(written(table).encode())


def written(table: Iterable[Line]) -> str:
    """Return a table as it is saved."""
    return "".join("\t".join(line) + "\n" for line in table)


def _line(grader: Grader, grading: Grading) -> Line:
    try:
        result = grader.grade(grading.job)
    except GraderError as error:
        return Line(grading.id, _REFUSED, *[_hash(str(error).encode())] * len(HASHES))
    report = result.report
    marks = [report.status, report.score, [(item.id, item.earned, item.points) for item in report.items]]
    moved = b"".join(result.trajectories[case] for case in sorted(result.trajectories))
    score = "-" if report.score is None else f"{report.score:g}"
    return Line(
        grading.id,
        score,
        _hash(repr(marks).encode()),
        _hash(moved),
        _hash(report.canonical_bytes()),
        _hash(canonical(_unhinted(report))),
    )


def _unhinted(report: GradeReport) -> GradeReport:
    items = tuple(replace(item, hint=EMPTY) for item in report.items)
    return replace(report, items=items, hint=EMPTY, mistakes=())


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:_DIGITS]
