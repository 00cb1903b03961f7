"""A result stored and the next submission claimed by one statement. For PostgreSQL.

Eleven ways to the server and back, and as many statements to send and to answer, cost a worker and the server
more than the rows do. So what makes one transaction is written as one statement: it ends the claim (the fence),
adds the rows of the grading, claims what is due next, and takes its announcement back. All of it depends on the
fence: for a claim that is no longer valid the statement does nothing.

Its commit does not wait for the disk. What a crash of the server takes away is graded again and comes out the
same.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from sqlalchemy import (
    CTE,
    ColumnElement,
    Connection,
    Row,
    Select,
    Table,
    TableClause,
    bindparam,
    func,
    literal_column,
    select,
    true,
)
from sqlalchemy.dialects.postgresql import JSONB, Insert, insert

from grader.contracts.submission import Claim
from grader.store.claiming import CHANGE, CLAIMING, DUE, fence
from grader.store.gradings import Details, Values
from grader.store.tables import GradedAssignmentRow, GradingRow, SubmissionRow, TrajectoryRow, table_of
from grader.store.work import Announcer

_submission, _grading, _trajectory = table_of(SubmissionRow), table_of(GradingRow), table_of(TrajectoryRow)
_assignment = table_of(GradedAssignmentRow)
_COMMIT_SOON: ColumnElement[str] = literal_column("set_config('synchronous_commit', 'off', true)")
"""Until this transaction ends."""
# psycopg remembers how it read a statement of at most 4,096 characters, so names are short: reading one anew takes
# 0.4 ms


@dataclass(frozen=True, slots=True)
class FinishedRows:
    """What a grading writes.

    Attributes:
        changes: to the row of the submission.
        grading: its own row. details: rows that belong to that.
        assignment: the row of the assignment. knows_assignment: whether that is known to be stored already.
    """

    changes: Values
    grading: Values
    details: Details
    assignment: Values
    knows_assignment: bool = False


def finish_at_once(
    connection: Connection,
    announcer: Announcer,
    claim: Claim,
    rows: FinishedRows,
    next_claim: Mapping[str, Any] | None,
) -> Row[Any] | None:
    """Write `rows` if `claim` is valid; return None if it is not.

    `next_claim`: what `CLAIMING` and `DUE` take; None: claim nothing.

    Returns:
        The columns of `CLAIMING`, all None where nothing is due, and one more.
    """
    values, shape = _values(rows)
    if next_claim is not None:
        shape = shape._replace(claims=True)
        values |= next_claim
    statement = _finishing(announcer.taking_back, shape)
    return connection.execute(statement, values | fence(claim)).first()


class _Shape(NamedTuple):
    """What a statement consists of: names of columns, tables whose rows come as a list, numbers."""

    changed: tuple[str, ...]
    graded: tuple[str, ...]
    listed: tuple[TableClause, ...]
    trajectories: int
    adds_assignment: bool
    claims: bool


def _values(rows: FinishedRows) -> tuple[Values, _Shape]:
    """Return the values of a statement that claims nothing, and its shape."""
    values = _prefixed("s", rows.changes) | _prefixed("g", rows.grading)
    if not rows.knows_assignment:
        values |= _prefixed("a", rows.assignment)
    listed: list[TableClause] = []
    trajectories = 0
    for statement, each in rows.details:
        if statement.table is _trajectory:
            trajectories = len(each)
            for number, row in enumerate(each):
                values |= _prefixed(f"t{number}", row)
        else:
            listed.append(statement.table)
            values[statement.table.name] = each
    shape = _Shape(
        tuple(rows.changes),
        tuple(rows.grading),
        tuple(listed),
        trajectories,
        adds_assignment=not rows.knows_assignment,
        claims=False,
    )
    return values, shape


@cache  # a handful: by whether there are mistakes, and by the number of cases
def _finishing(taking_back: Callable[[CTE], CTE | None], shape: _Shape) -> Select[Any]:
    row = _submission.c
    changes = {name: bindparam(f"s_{name}", type_=row[name].type) for name in shape.changed}
    alike = [row[name] for name in shape.graded if name in row]
    fenced = CHANGE.values(changes).returning(row.id.label("submission_id"), *alike).cte("f")
    parts = [_added(_grading, shape.graded, "g", fenced).cte("g")]
    parts += [_listed(table, fenced).cte(f"each_{table.name}") for table in shape.listed]
    parts += [
        _added(_trajectory, _trajectory.c.keys(), f"t{number}", fenced).cte(f"of{number}")
        for number in range(shape.trajectories)
    ]
    if shape.adds_assignment:
        added = _added(_assignment, _assignment.c.keys(), "a", fenced)
        parts.append(added.on_conflict_do_nothing().cte("as_graded"))
    if not shape.claims:
        return select(_COMMIT_SOON).select_from(fenced).add_cte(*parts)
    due = DUE.where(select(fenced.c.submission_id).exists()).with_for_update(skip_locked=True)
    claimed = CLAIMING.where(row.id == due.scalar_subquery()).cte("c")
    taken_back = taking_back(claimed)
    if taken_back is not None:
        parts.append(taken_back)
    both = fenced.outerjoin(claimed, true())
    return select(*claimed.c, _COMMIT_SOON).select_from(both).add_cte(*parts)


def _added(table: Table, names: Collection[str], prefix: str, fenced: CTE) -> Insert:
    """Insert one row of the values `prefix`_name, and of what `fenced` has under the same names."""
    known = fenced.c
    values = [
        known[name] if name in known else bindparam(f"{prefix}_{name}", type_=table.c[name].type)
        for name in names
    ]
    row: Select[Any] = select(*values).select_from(fenced)
    return insert(table).from_select(list(names), row)


def _listed(table: TableClause, fenced: CTE) -> Insert:
    """Insert the rows that the value of the table's name lists, as JSON."""
    known = fenced.c
    listed = func.jsonb_to_recordset(bindparam(table.name, type_=JSONB))
    each = listed.table_valued(*(one for one in table.c if one.name not in known))
    each = each.render_derived(name="one", with_types=True)
    columns = [known[one.name] if one.name in known else each.c[one.name] for one in table.c]
    rows: Select[Any] = select(*columns).select_from(fenced.join(each, true()))
    return insert(table).from_select(table.c.keys(), rows)


def _prefixed(prefix: str, values: Values) -> Values:
    return {f"{prefix}_{name}": value for name, value in values.items()}
