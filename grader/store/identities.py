"""Which names at sign-in providers belong to which members of courses, and the sessions that these open."""

import secrets
from datetime import timedelta

from sqlalchemy import delete, func, select
from sqlmodel import col

from grader.contracts.identity import Identity, Role
from grader.store.audit import Signature, record
from grader.store.clock import TimedPart
from grader.store.database import one_at_a_time
from grader.store.tables import CourseRow, IdentityRow, MemberRow, RecognisedRow, TokenRow, as_contract
from grader.store.tokens import digest_of, new_session

_SECRET_BYTES = 32
_ID_BYTES = 6
_PATIENCE = timedelta(minutes=10)
_MOST_COURSES = 20


class Identities(TimedPart):
    """Binds names at providers to members; safe to share between threads."""

    def of_subject(self, provider: str, subject: str) -> tuple[Identity, ...]:
        """Return the identities of a provider's `subject`: courses not archived first, then the newest."""
        statement = (
            select(IdentityRow)
            .join(CourseRow, col(CourseRow.id) == col(IdentityRow.course))
            .where(col(IdentityRow.provider) == provider, col(IdentityRow.subject) == subject)
            .order_by(
                col(CourseRow.archived_at).is_not(None), col(CourseRow.created_at).desc(), col(CourseRow.id)
            )
            .limit(_MOST_COURSES)
        )
        return tuple(as_contract(row, Identity) for row in self._scalars(statement))

    def subjects(self, provider: str) -> frozenset[str]:
        """Return the names at a provider that are bound to a member of any course."""
        mine = select(col(IdentityRow.subject)).where(col(IdentityRow.provider) == provider)
        return frozenset(self._scalars(mine))

    def of_member(self, course: str, person: str) -> tuple[Identity, ...]:
        """Return the identities of a member, oldest first."""
        own = col(IdentityRow.course) == course, col(IdentityRow.person) == person
        statement = select(IdentityRow).where(*own).order_by(col(IdentityRow.bound_at), col(IdentityRow.id))
        return tuple(as_contract(row, Identity) for row in self._scalars(statement))

    def bind_claimed(
        self,
        provider: str,
        subject: str,
        *,
        persons: tuple[str, ...] = (),
        email: str = "",
        within: str | None = None,
    ) -> None:
        """Bind a subject to the student of one of these ids, or of that address, in each course that is taught.

        Courses where the subject is known are left out. A provider's word gives nobody a role: staff bind by a
        token. Where more than one student of a course fits, nobody is bound. `within`: in this course only.
        """
        member = MemberRow
        if not persons and not email:
            return
        named = col(member.person).in_(persons) if persons else func.lower(col(member.email)) == _small(email)
        course = col(member.course).is_not(None) if within is None else col(member.course) == within
        bound = select(col(IdentityRow.course)).where(
            col(IdentityRow.provider) == provider, col(IdentityRow.subject) == subject
        )
        statement = (
            select(col(member.course), col(member.person))
            .join(CourseRow, col(CourseRow.id) == col(member.course))
            .where(
                named,
                course,
                col(member.course).not_in(bound),
                col(member.role) == Role.STUDENT.value,
                col(CourseRow.archived_at).is_(None),
            )
            .limit(_MOST_COURSES)
        )
        with self._database.reading() as session:
            claimed = [(course, one) for course, one in session.execute(statement)]
        courses = [course for course, _ in claimed]
        for course, one in claimed:
            if courses.count(course) == 1:
                self.bind(provider, subject, course, one, by_token=False)

    def bind(self, provider: str, subject: str, course: str, person: str, *, by_token: bool) -> bool:
        """Bind a provider's `subject` to a member; return whether it is bound to that member now.

        A subject that is bound to another member of the course stays bound to that one. Without a token, a member
        to whom another subject of the provider is bound is not bound again.
        """
        with self._database.writing() as session:
            one_at_a_time(session, "identity", course)
            rows = session.execute(
                select(IdentityRow).where(
                    col(IdentityRow.provider) == provider,
                    col(IdentityRow.course) == course,
                    (col(IdentityRow.subject) == subject) | (col(IdentityRow.person) == person),
                )
            ).scalars()
            bound = {row.subject: row.person for row in rows}
            if subject in bound:
                return bool(bound[subject] == person)
            if (bound and not by_token) or session.get(MemberRow, (course, person)) is None:
                return False
            row = IdentityRow(
                id=secrets.token_hex(_ID_BYTES),
                provider=provider,
                subject=subject,
                course=course,
                person=person,
                bound_at=self._clock(),
                by_token=by_token,
            )
            session.add(row)
            after = {"provider": provider, "subject": subject}
            signed = Signature(row.bound_at, course, person)
            record(session, signed, "signin.bind", f"member {person}", after=after)
            return True

    def unbind(self, identity_id: str, course: str, person: str, actor: str) -> bool:
        """End a binding and the sessions that it opened; return whether there was such a one."""
        with self._database.writing() as session:
            row = session.get(IdentityRow, identity_id)
            if row is None or (row.course, row.person) != (course, person):
                return False
            session.execute(
                delete(TokenRow).where(col(TokenRow.course) == course, col(TokenRow.opened_by) == row.id)
            )
            session.delete(row)
            before = {"provider": row.provider, "subject": row.subject}
            signed = Signature(self._clock(), course, actor)
            record(session, signed, "signin.unbind", f"member {person}", before=before)
            return True

    def open_session(self, identity: Identity) -> str | None:
        """Open a browser's session for an identity; None if the identity is bound no longer."""
        with self._database.writing() as session:
            if session.get(IdentityRow, identity.id) is None:
                return None
            return new_session(session, identity.course, identity.person, identity.id, self._clock())

    def hold(self, provider: str, subject: str) -> str:
        """Remember for ten minutes who was recognised; return the secret that the browser keeps."""
        now, secret = self._clock(), secrets.token_urlsafe(_SECRET_BYTES)
        row = RecognisedRow(
            sha256=digest_of(secret), provider=provider, subject=subject, expires_at=now + _PATIENCE
        )
        with self._database.writing() as session:
            session.execute(delete(RecognisedRow).where(col(RecognisedRow.expires_at) <= now))
            session.add(row)
        return secret

    def held(self, secret: str) -> tuple[str, str] | None:
        """Return provider and subject of who was recognised; None when that is too long ago."""
        row = self._get(RecognisedRow, digest_of(secret))
        is_held = row is not None and row.expires_at > self._clock()
        return (row.provider, row.subject) if row is not None and is_held else None

    def let_go(self, secret: str) -> None:
        """Forget who was recognised."""
        with self._database.writing() as session:
            session.execute(delete(RecognisedRow).where(col(RecognisedRow.sha256) == digest_of(secret)))


def _small(address: str) -> str:
    """Return an address with small Latin letters. No other letter becomes one, as the Kelvin sign would."""
    return "".join(letter.lower() if letter.isascii() else letter for letter in address)
