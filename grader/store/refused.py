"""Uploads of students that were refused: what staff see of somebody who never gets as far as a grading."""

import secrets

from sqlalchemy import delete, select
from sqlmodel import col

from grader.contracts.submission import RefusedUpload
from grader.store.clock import TimedPart
from grader.store.tables import MemberRow, RefusedUploadRow, as_contract

_MOST = 50  # of one student; older ones are dropped
_ID_BYTES = 8


class RefusedUploads(TimedPart):
    """Keeps the latest refusals of each student; safe to share between threads."""

    def add(  # noqa: PLR0913, PLR0917
        self, course: str, person: str, assignment: str, code: str, file_name: str, line: int | None
    ) -> None:
        """Note a refusal of a member's upload; of anybody else's nothing."""
        row = RefusedUploadRow(
            id=secrets.token_hex(_ID_BYTES),
            course=course,
            person=person,
            assignment=assignment,
            at=self._clock(),
            code=code,
            file_name=file_name,
            line=line,
        )
        own = col(RefusedUploadRow.course) == course, col(RefusedUploadRow.person) == person
        newest = select(col(RefusedUploadRow.id)).where(*own).order_by(col(RefusedUploadRow.at).desc())
        with self._database.writing() as session:
            if session.get(MemberRow, (course, person)) is None:
                return
            kept = newest.limit(_MOST - 1)
            session.execute(delete(RefusedUploadRow).where(*own, col(RefusedUploadRow.id).not_in(kept)))
            session.add(row)

    def of(self, course: str | None, person: str | None = None) -> tuple[RefusedUpload, ...]:
        """Return the refusals of a course, newest first; of one student, or of all."""
        own = [col(RefusedUploadRow.course) == course]
        if person is not None:
            own.append(col(RefusedUploadRow.person) == person)
        statement = select(RefusedUploadRow).where(*own).order_by(col(RefusedUploadRow.at).desc())
        return tuple(as_contract(row, RefusedUpload) for row in self._scalars(statement))
