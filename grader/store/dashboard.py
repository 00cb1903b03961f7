"""What an instructor asks of the rows: the class matrix, and what is failed and mistaken most."""

import threading
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from sqlalchemy import func, select
from sqlmodel import Session, col

from grader.contracts.dashboard import ClassState, ItemFailures, MistakeCount
from grader.store.class_cells import Cell, Place, counted
from grader.store.course_tables import AuditRow
from grader.store.database import Database
from grader.store.rules import rules_of
from grader.store.tables import SubmissionRow


@dataclass(frozen=True, slots=True)
class _Known:
    """What was last counted about a course."""

    state: ClassState
    cells: dict[Place, Cell]


class Dashboard:
    """Counts over all submissions; safe to share between threads."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._latest: dict[str | None, _Known] = {}
        self._counting = threading.Lock()

    def state(self, course: str | None = None) -> ClassState:
        """Count everything of a course on one snapshot, students in order of name.

        Without courses (None) everything that was handed in is one class. While nothing changes, counting
        again is a matter of looking at the marks.
        """
        with self._database.reading() as session:
            mark = _mark(session, course)
            known = self._latest.get(course)
            if known is not None and known.state.mark == mark:
                return known.state
        with self._counting, self._database.reading() as session:  # who comes second finds it counted
            return self._count(session, course)

    def _count(self, session: Session, course: str | None) -> ClassState:
        mark, known = _mark(session, course), self._latest.get(course)
        if known is not None and known.state.mark == mark:
            return known.state
        before = {} if known is None else known.cells
        cells = counted(session, course, rules_of(session, course), before)
        state = ClassState(
            progress=tuple(cell.progress for cell in cells.values()),
            failures=_failures(cells.values()),
            mistakes=_mistakes(cells.values()),
            mark=mark,
        )
        self._latest[course] = _Known(state, cells)
        return state


def _mark(session: Session, course: str | None) -> str:
    """Return what changes with everything that is counted: claims, gradings, states, people and rules.

    Claims and gradings raise their numbers for ever, so no two changes cancel out; people, rules, judgements and
    re-grades are in the audit log.
    """
    row = SubmissionRow
    sums = select(
        col(row.state),
        func.count(),
        func.sum(col(row.attempt)),
        func.sum(func.coalesce(col(row.graded_attempt), 0)),
    ).where(col(row.course) == course, col(row.regrade).is_(None))
    states = session.execute(sums.group_by(col(row.state)).order_by(col(row.state))).all()
    # their number, not the newest: on PostgreSQL an older one may be committed later
    changes = session.execute(
        select(func.count()).select_from(AuditRow).where(col(AuditRow.course) == course)
    ).scalar_one()
    return repr(([tuple(one) for one in states], changes))


def _failures(cells: Iterable[Cell]) -> tuple[ItemFailures, ...]:
    ever: Counter[tuple[str, str]] = Counter()
    still: Counter[tuple[str, str]] = Counter()
    for cell in cells:
        assignment = cell.progress.assignment
        ever.update((assignment, item) for item in cell.failed)
        still.update((assignment, item) for item in cell.still)
    failures = (
        ItemFailures(assignment=assignment, item=item, ever=count, still=still[assignment, item])
        for (assignment, item), count in ever.items()
    )
    return tuple(sorted(failures, key=lambda one: (one.assignment, -one.ever, one.item)))


def _mistakes(cells: Iterable[Cell]) -> tuple[MistakeCount, ...]:
    made = Counter((cell.progress.assignment, code) for cell in cells for code in cell.mistakes)
    counts = (
        MistakeCount(assignment=assignment, code=code, students=count)
        for (assignment, code), count in made.items()
    )
    return tuple(sorted(counts, key=lambda one: (one.assignment, -one.students, one.code)))
