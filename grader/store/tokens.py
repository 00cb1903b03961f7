"""Bearer tokens: issued, recognised, revoked. A secret is shown once; the store keeps its SHA-256.

A browser that shows a token gets a session: a secret of its own, good for pages alone and for as long as the
course says, which ends with the token. So whoever gets hold of a browser's cookie has no token. Who signs in by a
provider gets the same kind of session (`grader.store.identities`).

People type tokens from a slip of paper, so a token is a code of ten characters: 47 random bits. Its digest is one
that takes time to make (scrypt, some 10 ms), so whoever steals the database alone tries for some 150 years of a
core before they have the first of 300 codes; how often one may guess at a service is bounded by
`grader.use_cases.callers`. Sessions, and tokens of before there were codes, have 256 random bits: their plain
digest cannot be searched backwards. Looking up a digest tells nothing about how close a guess was.
"""

import hashlib
import os
import re
import secrets
import unicodedata
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime, timedelta
from functools import lru_cache

from sqlalchemy import ColumnElement, CursorResult, delete, select, update
from sqlmodel import Session, col

from grader.contracts.identity import Caller, Role, TokenInfo, unknown_members
from grader.store.audit import Signature, record, record_all
from grader.store.clock import TimedPart
from grader.store.courses import bound_to
from grader.store.tables import CourseRow, MemberRow, TokenRow, as_contract

_SECRET_BYTES = 32
_ID_BYTES = 6
MOST_SESSIONS = 20
"""Of one member: whoever opens more ends the oldest. Without a bound one token could fill the database."""
_ALPHABET = "23456789ACDEFHJKMNPQRTVWXY"
_LOOK_ALIKES = str.maketrans("ZSBGU", "2586V")  # each is read as the one that codes have; 0 O 1 I L have none
_GROUP, _GROUPS = 5, 2
_CODE = re.compile(f"[{_ALPHABET}]{{{_GROUP * _GROUPS}}}")
_SCRYPT = {"n": 2**12, "r": 8, "p": 1, "dklen": 32}
_SALT = b"grader token"  # the same for all: a code alone must lead to its row
_REMEMBERED = 4_096  # digests of codes, so that a program's every request does not cost 10 ms


class Tokens(TimedPart):
    """The tokens of all courses; safe to share between threads."""

    def issue(self, course: str, person: str, valid_for: timedelta, actor: str) -> tuple[TokenInfo, str]:
        """Make a token for a member; return what is kept of it and the token itself.

        Raises CourseError: there is no such member.
        """
        (token,) = self.issue_all(course, [person], valid_for, actor)
        return token

    def issue_all(
        self, course: str, people: Sequence[str], valid_for: timedelta, actor: str
    ) -> list[tuple[TokenInfo, str]]:
        """Do what `issue` does for each of several people, in one transaction."""
        now = self._clock()
        codes = {person: _new_code() for person in people}
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # the digests take what time this takes
            token_rows = pool.map(lambda one: _row(codes[one], course, one, now, now + valid_for), people)
            rows = {row.person: row for row in token_rows}
        with self._database.writing() as session:
            members = select(col(MemberRow.person)).where(col(MemberRow.course) == course)
            if unknown := rows.keys() - set(session.execute(members).scalars()):
                raise unknown_members(course, *sorted(unknown))
            session.add_all(rows.values())
            details = {
                f"member {person}": {"token": row.id, "expires_at": row.expires_at.isoformat()}
                for person, row in rows.items()
            }
            record_all(session, Signature(now, course, actor), "token.issue", details)
            return [(as_contract(row, TokenInfo), codes[person]) for person, row in rows.items()]

    def caller(self, secret: str) -> Caller | None:
        """Return who shows the token `secret`; None when it is unknown, expired or revoked."""
        return self._caller(secret, col(TokenRow.opened_by).is_(None))

    def open_session(self, secret: str) -> str | None:
        """Open a session for a browser that shows the token `secret`; None when that opens nothing."""
        now = self._clock()
        with self._database.writing() as session:
            token = session.execute(
                select(TokenRow).where(*_open(secret, now), col(TokenRow.opened_by).is_(None))
            ).scalar_one_or_none()
            if token is None:
                return None
            return new_session(session, token.course, token.person, token.id, now, token.expires_at)

    def session_caller(self, secret: str) -> Caller | None:
        """Return whose session it is; None when it is unknown, closed or over, or its token was revoked."""
        return self._caller(secret, col(TokenRow.opened_by).is_not(None))

    def close_session(self, secret: str) -> None:
        """End a session, if there is such a one."""
        own = (col(TokenRow.sha256) == _digest(secret), col(TokenRow.opened_by).is_not(None))
        with self._database.writing() as session:
            session.execute(delete(TokenRow).where(*own))

    def _caller(self, secret: str, kind: ColumnElement[bool]) -> Caller | None:
        statement = (
            select(col(MemberRow.course), col(MemberRow.person), col(MemberRow.role))
            .join(
                TokenRow,
                (col(TokenRow.course) == col(MemberRow.course))
                & (col(TokenRow.person) == col(MemberRow.person)),
            )
            .where(*_open(secret, self._clock()), kind)
        )
        with self._database.reading() as session:
            row = session.execute(statement).first()
            if row is None:
                return None
            course, person, role = row[0], row[1], Role(row[2])
            students = bound_to(session, course, person) if role is Role.ASSISTANT else None
        return Caller(course=course, person=person, role=role, students=students)

    def of_course(self, course: str) -> tuple[TokenInfo, ...]:
        """Return the tokens of a course, oldest first."""
        of_it = select(TokenRow).where(col(TokenRow.course) == course, col(TokenRow.opened_by).is_(None))
        statement = of_it.order_by(col(TokenRow.created_at), col(TokenRow.id))
        return tuple(as_contract(row, TokenInfo) for row in self._scalars(statement))

    def holders(self, course: str) -> frozenset[str]:
        """Return who in a course has a token that opens something now."""
        now = self._clock()
        tokens = self.of_course(course)
        return frozenset(
            token.person for token in tokens if token.revoked_at is None and token.expires_at > now
        )

    def revoke(
        self, course: str, actor: str, *, token_id: str | None = None, person: str | None = None
    ) -> int:
        """Revoke one token, or every token of a person, for good; return how many still opened something."""
        now = self._clock()
        which = col(TokenRow.id) == token_id if person is None else col(TokenRow.person) == person
        opened = col(TokenRow.opened_by) == token_id if person is None else col(TokenRow.person) == person
        tokens = (col(TokenRow.course) == course, which, col(TokenRow.opened_by).is_(None))
        still_open = col(TokenRow.revoked_at).is_(None)
        with self._database.writing() as session:
            session.execute(
                delete(TokenRow).where(
                    col(TokenRow.course) == course, opened, col(TokenRow.opened_by).is_not(None)
                )
            )
            result = session.execute(update(TokenRow).where(*tokens, still_open).values(revoked_at=now))
            assert isinstance(result, CursorResult)
            if result.rowcount:
                subject = f"token {token_id}" if person is None else f"member {person}"
                record(
                    session,
                    Signature(now, course, actor),
                    "token.revoke",
                    subject,
                    before={"open": result.rowcount},
                )
            return result.rowcount


def new_session(  # noqa: PLR0913, PLR0917
    session: Session, course: str, person: str, opened_by: str, now: datetime, until: datetime | None = None
) -> str:
    """Add a session of a member, in place of those that are over and of the oldest; return its secret.

    It ends with the token, or the identity, of the id `opened_by`, at the latest `until`, and after the
    course's hours.
    """
    secret, taught = secrets.token_urlsafe(_SECRET_BYTES), session.get_one(CourseRow, course)
    latest = now + timedelta(hours=taught.session_hours)
    of_member = col(TokenRow.course) == course, col(TokenRow.person) == person
    own = *of_member, col(TokenRow.opened_by).is_not(None)
    newest = select(col(TokenRow.id)).where(*own).order_by(col(TokenRow.created_at).desc())
    kept = col(TokenRow.id).in_(newest.limit(MOST_SESSIONS - 1)) & (col(TokenRow.expires_at) > now)
    session.execute(delete(TokenRow).where(*own, ~kept))
    end = latest if until is None else min(latest, until)
    session.add(_row(secret, course, person, now, end, opened_by=opened_by))
    return secret


def _open(secret: str, now: datetime) -> tuple[ColumnElement[bool], ...]:
    """Return what is true of the row that a secret opens."""
    return (
        col(TokenRow.sha256) == _digest(secret),
        col(TokenRow.revoked_at).is_(None),
        col(TokenRow.expires_at) > now,
    )


def _row(  # noqa: PLR0913, PLR0917
    secret: str, course: str, person: str, now: datetime, until: datetime, opened_by: str | None = None
) -> TokenRow:
    return TokenRow(
        id=secrets.token_hex(_ID_BYTES),
        sha256=_digest(secret),
        course=course,
        person=person,
        created_at=now,
        expires_at=until,
        opened_by=opened_by,
    )


def code_in(text: str) -> str | None:
    """Return the token's code that `text` shows; None if it is none."""
    code = typed_code(text)
    return code if _CODE.fullmatch(code) else None


def typed_code(text: str) -> str:
    """Return what somebody typed in whatever case, width and grouping as `random_code` writes it."""
    shown = unicodedata.normalize("NFKC", text).upper()
    return re.sub(r"[\s\-‐-―]", "", shown).translate(_LOOK_ALIKES)


def random_code(length: int) -> str:
    """Return letters and digits of which none looks like another: one of 26 to the power of `length`."""
    return "".join(secrets.choice(_ALPHABET) for _ in range(length))


def _new_code() -> str:
    code = random_code(_GROUP * _GROUPS)
    return "-".join(code[at : at + _GROUP] for at in range(0, len(code), _GROUP))


def _digest(secret: str) -> str:
    code = code_in(secret)
    return digest_of(secret) if code is None else _slow_digest(code)


@lru_cache(maxsize=_REMEMBERED)
def _slow_digest(code: str) -> str:
    return hashlib.scrypt(code.encode(), salt=_SALT, **_SCRYPT).hex()


def digest_of(secret: str) -> str:
    """Return what is kept of a secret; of one that a browser made up, too, which may be no text at all."""
    return hashlib.sha256(secret.encode(errors="replace")).hexdigest()
