"""What members are writing: one text for each assignment, the latest."""

from sqlalchemy import delete
from sqlmodel import col

from grader.store.audit import Signature, require_open
from grader.store.database import StorePart
from grader.store.tables import DraftRow


class Drafts(StorePart):
    """Keeps drafts; safe to share between threads."""

    def of(self, course: str, person: str, assignment: str) -> str | None:
        """Return what a member last wrote for an assignment; None: nothing, or no more."""
        row = self._get(DraftRow, (course, person, assignment))
        return None if row is None else row.text

    def keep(self, signed: Signature, assignment: str, text: str | None) -> None:
        """Keep `text` as what whoever signs is writing; None: nothing any more.

        Raises RefusedError: the course is archived.
        """
        course, person = signed.course or "", signed.actor
        with self._database.writing() as session:
            require_open(session, course)
            own = col(DraftRow.course) == course, col(DraftRow.person) == person
            if text is None:
                session.execute(delete(DraftRow).where(*own, col(DraftRow.assignment) == assignment))
                return
            row = DraftRow(course=course, person=person, assignment=assignment, text=text, saved_at=signed.at)
            session.merge(row)
