"""What staff says to every student of a course who makes a mistake at an assignment."""

from sqlalchemy import delete, select
from sqlmodel import col

from grader.store.audit import Signature, require_open
from grader.store.database import StorePart
from grader.store.tables import PinnedRow


class Pinned(StorePart):
    """Keeps what is pinned to mistakes; safe to share between threads."""

    def of(self, course: str | None, assignment: str) -> dict[str, str]:
        """Return what is pinned at an assignment, by the code of the mistake, in order."""
        row = PinnedRow
        own = select(row).where(col(row.course) == course, col(row.assignment) == assignment)
        return {pinned.mistake: pinned.text for pinned in self._scalars(own.order_by(col(row.mistake)))}

    def pin(self, assignment: str, mistake: str, text: str, signed: Signature) -> None:
        """Pin `text` to a mistake in place of what was there; empty: nothing.

        Raises RefusedError: the course is archived.
        """
        course, row = signed.in_course(), PinnedRow
        with self._database.writing() as session:
            require_open(session, course)
            if text:
                session.merge(row(course=course, assignment=assignment, mistake=mistake, text=text))
                return
            one = col(row.course) == course, col(row.assignment) == assignment, col(row.mistake) == mistake
            session.execute(delete(row).where(*one))
