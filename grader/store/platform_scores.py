"""The scores that learning platforms have. Where they differ from what counts now, they are sent next.

So whatever changes a score (a grading, a person, a rule, a date) is sent, with no transaction having to note it,
and a process that dies between telling and noting tells the same once more.
"""

from datetime import datetime, timedelta

from sqlalchemy import select, update
from sqlmodel import col

from grader.contracts.platform import Platform, PlatformLink, PlatformScore, provider_of
from grader.store.clock import TimedPart, ahead, longer_pause
from grader.store.database import one_at_a_time
from grader.store.tables import (
    IdentityRow,
    PlatformLinkRow,
    PlatformRow,
    PlatformScoreRow,
    as_contract,
)

PATIENCE = timedelta(minutes=1)
"""As long as one process may take for one score before another sends it, too."""

_FIRST_PAUSE_S = 30.0
_LONGEST_TROUBLE = 500


class PlatformScores(TimedPart):
    """Keeps what was sent; safe to share between threads and processes."""

    def targets(self) -> tuple[tuple[Platform, PlatformLink], ...]:
        """Return every activity whose platform takes scores and that leads to an assignment."""
        statement = (
            select(PlatformRow, PlatformLinkRow)
            .join(PlatformLinkRow, col(PlatformLinkRow.platform) == col(PlatformRow.id))
            .where(col(PlatformLinkRow.line_item) != "", col(PlatformLinkRow.assignment) != "")
            .order_by(col(PlatformRow.id), col(PlatformLinkRow.resource))
        )
        rows = self._rows(statement)
        return tuple((as_contract(one, Platform), as_contract(link, PlatformLink)) for one, link in rows)

    def people(self, platform: Platform) -> dict[str, str]:
        """Return by member what the platform calls them; of several names the first that was bound."""
        row = IdentityRow
        mine = col(row.provider) == platform.provider, col(row.course) == platform.course
        statement = select(col(row.person), col(row.subject)).where(*mine).order_by(col(row.bound_at).desc())
        return {str(person): str(subject) for person, subject in self._rows(statement)}

    def of_link(self, link: PlatformLink) -> dict[str, PlatformScore]:
        """Return by member what was sent for an activity."""
        row = PlatformScoreRow
        mine = col(row.platform) == link.platform, col(row.resource) == link.resource
        rows = self._scalars(select(PlatformScoreRow).where(*mine))
        return {score.person: as_contract(score, PlatformScore) for score in rows}

    def troubles(self, course: str) -> tuple[PlatformScore, ...]:
        """Return what platforms do not take of a course."""
        row = PlatformScoreRow
        statement = select(PlatformScoreRow).where(col(row.course) == course, col(row.trouble) != "")
        rows = self._scalars(statement.order_by(col(row.person), col(row.resource)))
        return tuple(as_contract(score, PlatformScore) for score in rows)

    def claim(self, link: PlatformLink, course: str, person: str, sha256: str) -> PlatformScore | None:
        """Claim the sending of the score of that digest; return what was known of it.

        None: another process sends or has sent it, it is too early after a failure, the platform was removed, or
        the member is not known there any more. Until `sent` is called, nobody knows what the platform has: the
        process may die, or get no answer.
        """
        now, row = self._clock(), PlatformScoreRow
        with self._database.writing() as session:
            one_at_a_time(session, "platform_link", link.platform)  # as `Platforms.remove`
            if session.get(PlatformLinkRow, (link.platform, link.resource)) is None:
                return None
            bound = select(col(IdentityRow.id)).where(
                col(IdentityRow.provider) == provider_of(link.platform),
                col(IdentityRow.course) == course,
                col(IdentityRow.person) == person,
            )
            if session.execute(bound.limit(1)).first() is None:
                return None
            score_row = session.get(PlatformScoreRow, (link.platform, link.resource, person))
            if score_row is None:
                score_row = row(
                    platform=link.platform,
                    resource=link.resource,
                    course=course,
                    person=person,
                    not_before=now,
                )
                session.add(score_row)
            if ahead(score_row.not_before, now) or score_row.sha256 == sha256:
                return None
            score = as_contract(score_row, PlatformScore)
            score_row.not_before, score_row.sha256 = now + PATIENCE, ""
            return score

    def sent(self, link: PlatformLink, person: str, sha256: str, at: datetime) -> None:
        """Note that the platform took a score."""
        self._note(link, person, sha256=sha256, sent_at=at, not_before=self._clock(), tries=0, trouble="")

    def failed(self, link: PlatformLink, person: str, tries: int, trouble: str) -> None:
        """Note that it did not, for the `tries`-th time in a row: the pause until the next try doubles."""
        later = self._clock() + longer_pause(_FIRST_PAUSE_S, tries)
        self._note(link, person, not_before=later, tries=tries, trouble=trouble[:_LONGEST_TROUBLE])

    def _note(self, link: PlatformLink, person: str, **values: object) -> None:
        row = PlatformScoreRow
        key = (
            col(row.platform) == link.platform,
            col(row.resource) == link.resource,
            col(row.person) == person,
        )
        with self._database.writing() as session:
            session.execute(update(PlatformScoreRow).where(*key).values(**values))
