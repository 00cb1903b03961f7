"""Comments that a course's staff use again, each under a short key."""

from collections.abc import Mapping

from sqlalchemy import delete, select
from sqlmodel import col

from grader.store.audit import Signature, require_open
from grader.store.database import StorePart, one_at_a_time
from grader.store.tables import PhraseRow


class Phrases(StorePart):
    """Keeps the phrases of courses; safe to share between threads."""

    def of(self, course: str | None) -> dict[str, str]:
        """Return the phrases of a course by key, in order of key."""
        statement = select(PhraseRow).where(col(PhraseRow.course) == course).order_by(col(PhraseRow.key))
        return {row.key: row.text for row in self._scalars(statement)}

    def set(self, phrases: Mapping[str, str], signed: Signature) -> None:
        """Put `phrases` in place of those of the course of `signed`.

        Raises RefusedError: the course is archived.
        """
        course = signed.in_course()
        with self._database.writing() as session:
            require_open(session, course)
            one_at_a_time(session, "phrases", course)
            session.execute(delete(PhraseRow).where(col(PhraseRow.course) == course))
            session.add_all(PhraseRow(course=course, key=key, text=text) for key, text in phrases.items())
