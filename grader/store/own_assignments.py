"""Assignments that were uploaded to courses: kept, handed to workers that run their scripts, taken or refused.

The row of an upload is the truth, as a submission's is in `grader.store.queue`: a worker claims it under a lease,
and writes only while its claim is the latest (`tries` fences). What is stored of an assignment is the upload that
the course uses and, if there is one, a later one that waits or was refused.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, and_, delete, exists, func, or_, select, update
from sqlmodel import Session, col

from grader.contracts.errors import RefusedError
from grader.contracts.own_assignment import Examined, OwnAssignment, OwnState
from grader.contracts.record import from_json
from grader.contracts.rules import Rules, Shown
from grader.store.audit import Signature, record
from grader.store.clock import TimedPart, ahead
from grader.store.database import one_at_a_time
from grader.store.rules import add_rules
from grader.store.tables import OwnAssignmentRow, RulesRow, SubmissionRow, as_contract, table_of

LEASE_S = 600.0
"""Longer than any script of an assignment runs; a claim is renewed before each."""

MOST_OWN = 100
"""Assignments of one course's own: each look at them reads all."""

_TROUBLE_CHARACTERS = 2_000
_row = OwnAssignmentRow
Mark = tuple[int, datetime]
"""Identifies an upload, also after one was removed and its number was given again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewOwnAssignment:
    """An upload that was read: the folder as a zip, and what reading it gave, as JSON.

    Attributes:
        draft: whether students see it only when somebody publishes it.
    """

    assignment: str
    version: int
    content: bytes
    reading: bytes
    draft: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnClaim:
    """The right of one worker to examine an upload until its lease ends.

    `tries` fences, with `uploaded_at`: after a removal the next upload has the same number.
    """

    course: str
    assignment: str
    number: int
    uploaded_at: datetime
    tries: int
    content: bytes
    reading: bytes


class OwnAssignments(TimedPart):
    """Keeps uploads of assignments; safe to share between threads."""

    def of(self, course: str) -> tuple[OwnAssignment, ...]:
        """Return all that is stored of a course's own assignments, by id and then by age."""
        own = select(_row).where(col(_row.course) == course)
        return tuple(map(_contract, self._scalars(own.order_by(col(_row.assignment), col(_row.number)))))

    def marks(self) -> Mapping[tuple[str, str], Mark]:
        """Return by course and assignment which upload is used."""
        ready = select(_row.course, _row.assignment, _row.number, _row.uploaded_at).where(  # type: ignore[call-overload]
            col(_row.state) == OwnState.READY.value
        )
        rows = self._rows(ready.order_by(col(_row.number)))
        return {(course, assignment): (number, at) for course, assignment, number, at in rows}

    def reading(self, course: str, assignment: str, number: int) -> bytes | None:
        """Return what reading an upload gave; None when it is not there any more."""
        row = self._get(_row, (course, assignment, number))
        return None if row is None else row.reading

    def in_use(self, course: str) -> Mapping[str, bytes]:
        """Return by assignment the folders that a course uses, as zips."""
        ready = col(_row.course) == course, col(_row.state) == OwnState.READY.value
        rows = self._scalars(select(_row).where(*ready).order_by(col(_row.number)))
        return {row.assignment: row.content for row in rows}

    def content(self, course: str, assignment: str) -> bytes | None:
        """Return the folder of the latest upload as a zip; None when there is none."""
        of = col(_row.course) == course, col(_row.assignment) == assignment
        latest = select(col(_row.content)).where(*of).order_by(col(_row.number).desc()).limit(1)
        return next(iter(self._scalars(latest)), None)

    def add(self, new: NewOwnAssignment, signed: Signature) -> None:
        """Keep an upload, which waits to be examined, in place of one that the course does not use.

        Without rules a `draft` begins as one: students see it when somebody publishes it.

        Raises RefusedError: the course is archived, or has `MOST_OWN` already.
        """
        course = signed.course or ""
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            of = col(_row.course) == course, col(_row.assignment) == new.assignment
            last = session.execute(select(func.max(col(_row.number))).where(*of)).scalar() or 0
            if not last and _ids(session, course) >= MOST_OWN:
                raise RefusedError("too_many_assignments")
            session.execute(delete(_row).where(*of, col(_row.state) != OwnState.READY.value))
            session.add(
                OwnAssignmentRow(
                    course=course,
                    assignment=new.assignment,
                    number=last + 1,
                    version=new.version,
                    state=OwnState.WAITING.value,
                    content=new.content,
                    reading=new.reading,
                    examined=b"{}",
                    uploaded_at=signed.at,
                    uploaded_by=signed.actor,
                    not_before=signed.at,
                )
            )
            if new.draft and session.get(RulesRow, (course, new.assignment)) is None:
                add_rules(session, new.assignment, Rules(shown=Shown.DRAFT), signed)
            after = {"version": new.version, "size_bytes": len(new.content)}
            record(session, signed, "assignment.upload", f"assignment {new.assignment}", after=after)

    def remove(self, assignment: str, signed: Signature, reason: str = "", *, in_use: bool = False) -> None:
        """Remove all that was uploaded of an assignment; with `in_use` also where something was handed in.

        Raises RefusedError: there is none, something was handed in for it, or the course is archived.
        """
        course = signed.course or ""
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            of = col(_row.course) == course, col(_row.assignment) == assignment
            # locked before the question whether something was handed in: `still_used` waits for what is decided
            locked = select(col(_row.version)).where(*of).order_by(col(_row.number).desc()).with_for_update()
            versions = session.execute(locked).scalars().all()
            if not versions:
                raise RefusedError("assignment_not_found")
            if not in_use and _handed_in(session, course, assignment):
                raise RefusedError("assignment_in_use")
            session.execute(delete(_row).where(*of))
            subject = f"assignment {assignment}"
            record(
                session,
                signed,
                "assignment.remove",
                subject,
                before={"version": max(versions)},
                reason=reason,
            )

    def claim(self) -> OwnClaim | None:
        """Take the upload that waits longest for its scripts to be run; None when none is due."""
        now = self._clock()
        due = (
            select(_row)
            .where(
                col(_row.state) == OwnState.WAITING.value,
                ~ahead(col(_row.not_before), now),
                or_(col(_row.lease_until).is_(None), ~ahead(col(_row.lease_until), now)),
            )
            .order_by(col(_row.uploaded_at))
            .limit(1)
        )
        with self._database.reading() as session:  # an idle look takes no write lock
            if session.execute(due).first() is None:
                return None
        with self._database.writing() as session:
            row = session.execute(due.with_for_update(skip_locked=True)).scalar_one_or_none()
            if row is None:
                return None
            row.lease_until = now + timedelta(seconds=LEASE_S)
            row.tries += 1
            return as_contract(row, OwnClaim)

    def renew(self, claim: OwnClaim, examined: bytes = b"{}") -> bool:
        """Begin the lease anew; False when the claim is not the latest, or the upload is gone.

        `examined`: how far its scripts are, as JSON.
        """
        until = self._clock() + timedelta(seconds=LEASE_S)
        return self._write(claim, {"lease_until": until, "examined": examined})

    def finish(self, claim: OwnClaim, examined: bytes, *, ready: bool, reading: bytes | None = None) -> bool:
        """Take an upload, or refuse it; False when the claim is void.

        Args:
            claim: which upload.
            examined: what running its scripts showed, as JSON.
            ready: the course uses it from now on, and those before it are not kept.
            reading: what reading it gave, if running the scripts added something.
        """
        state = OwnState.READY if ready else OwnState.REFUSED
        values = {"state": state.value, "examined": examined, "lease_until": None, "trouble": ""}
        return self._write(claim, values if reading is None else {**values, "reading": reading}, ready=ready)

    def hand_back(self, claim: OwnClaim, trouble: str, pause_s: float) -> bool:
        """Put an upload back to wait, after a fault that was not its own."""
        return self._write(
            claim,
            {
                "lease_until": None,
                "not_before": self._clock() + timedelta(seconds=pause_s),
                "trouble": trouble[:_TROUBLE_CHARACTERS],
            },
        )

    def _write(self, claim: OwnClaim, values: Mapping[str, object], *, ready: bool = False) -> bool:
        of = and_(col(_row.course) == claim.course, col(_row.assignment) == claim.assignment)
        latest = (
            col(_row.number) == claim.number,
            col(_row.uploaded_at) == claim.uploaded_at,
            col(_row.tries) == claim.tries,
            col(_row.state) == OwnState.WAITING.value,
        )
        with self._database.writing() as session:
            written: int = session.execute(update(_row).where(of, *latest).values(**values)).rowcount  # type: ignore[attr-defined]
            if ready and written:
                session.execute(delete(_row).where(of, col(_row.number) < claim.number))
            return written == 1


def still_used(session: Session, course: str | None, assignment: str) -> bool:
    """Return whether a course uses an own assignment, which nobody then removes before `session` has ended."""
    of = col(_row.course) == course, col(_row.assignment) == assignment
    # the newest first, as whoever takes an upload into use writes them: nobody waits in a circle
    locked = select(col(_row.state)).where(*of).order_by(col(_row.number).desc()).with_for_update(read=True)
    return OwnState.READY.value in session.execute(locked).scalars().all()


def copy_own_assignments(session: Session, course: str, signed: Signature) -> None:
    """Give the course of `signed` the assignments that another one uses, examined as they are."""
    ready = col(_row.course) == course, col(_row.state) == OwnState.READY.value
    fresh = {"course": signed.course, "number": 1, "uploaded_at": signed.at, "uploaded_by": signed.actor}
    for row in session.execute(select(_row).where(*ready)).scalars().all():
        values = {column.name: getattr(row, column.name) for column in table_of(_row).columns}
        session.add(OwnAssignmentRow(**{**values, **fresh}))


def _ids(session: Session, course: str) -> int:
    counted = select(func.count(col(_row.assignment).distinct())).where(col(_row.course) == course)
    return int(session.execute(counted).scalar_one())


def _handed_in(session: Session, course: str, assignment: str) -> bool:
    of: tuple[ColumnElement[bool], ...] = (
        col(SubmissionRow.course) == course,
        col(SubmissionRow.assignment) == assignment,
    )
    return bool(session.execute(select(exists().where(*of))).scalar())


def _contract(row: OwnAssignmentRow) -> OwnAssignment:
    return OwnAssignment(
        assignment=row.assignment,
        number=row.number,
        version=row.version,
        state=OwnState(row.state),
        uploaded_at=row.uploaded_at,
        uploaded_by=row.uploaded_by,
        examined=from_json(Examined, row.examined),
        trouble=row.trouble,
        size_bytes=len(row.content),
    )
