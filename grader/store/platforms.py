"""Learning platforms of courses, and the activities there that lead here."""

import secrets
from collections.abc import Callable
from dataclasses import asdict
from datetime import datetime, timedelta

from sqlalchemy import delete, select, update
from sqlalchemy.exc import IntegrityError
from sqlmodel import Session, col

from grader.contracts.errors import RefusedError
from grader.contracts.platform import NewPlatform, OpenPicking, Picking, Platform, PlatformLink
from grader.store.audit import Signature, record
from grader.store.clock import TimedPart
from grader.store.database import one_at_a_time
from grader.store.tables import (
    IdentityRow,
    PlatformInvitationRow,
    PlatformKeyRow,
    PlatformLinkRow,
    PlatformPickingRow,
    PlatformRow,
    PlatformScoreRow,
    TokenRow,
    UsedMessageRow,
    as_contract,
)
from grader.store.tokens import digest_of

_ADDRESSES = ("login_url", "token_url", "keys_url")
_ID_BYTES = 6
_SECRET_BYTES = 32
_SKEW = timedelta(minutes=2)
_PICKING = timedelta(hours=1)
_INVITATION = timedelta(hours=24)
KEY_READ_WITHIN = timedelta(hours=2)
"""A platform reads the service's keys again after an hour (`Cache-Control` of ``/lti/keys``), or sooner."""
MOST_PLATFORMS = 10
"""Of one course."""


class Platforms(TimedPart):
    """Keeps platforms; safe to share between threads."""

    def add(self, new: NewPlatform, signed: Signature) -> Platform:
        """Add a platform, which may then send people to the course of `signed`.

        Raises:
            RefusedError: it is there already, for this course or another; another deployment of it has other
                addresses; or the course has too many.
        """
        course = signed.course or ""
        row = PlatformRow(
            id=secrets.token_hex(_ID_BYTES),
            course=course,
            created_at=signed.at,
            **asdict(new),
        )
        try:
            with self._database.writing() as session:
                one_at_a_time(session, "platform", course)
                platforms = session.execute(
                    select(col(PlatformRow.id)).where(col(PlatformRow.course) == course)
                )
                if len(platforms.all()) >= MOST_PLATFORMS:
                    raise RefusedError("too_many_platforms")
                same = (col(PlatformRow.issuer) == new.issuer, col(PlatformRow.client_id) == new.client_id)
                first = session.scalars(select(PlatformRow).where(*same).limit(1)).first()
                if first is not None and any(
                    getattr(first, name) != getattr(row, name) for name in _ADDRESSES
                ):
                    raise RefusedError("platform_differs")
                session.add(row)
                after = {"title": new.title, "issuer": new.issuer, "client_id": new.client_id}
                record(session, signed, "platform.add", f"platform {row.id}", after=after)
                session.flush()
                return as_contract(row, Platform)
        except IntegrityError:
            raise RefusedError("platform_exists") from None

    def remove(self, platform_id: str, signed: Signature) -> bool:
        """Take a platform away, with its activities and the bindings of its people, if it is there."""
        with self._database.writing() as session:
            one_at_a_time(session, "platform_link", platform_id)
            row = session.get(PlatformRow, platform_id)
            if row is None or row.course != signed.course:
                return False
            provider = as_contract(row, Platform).provider
            bound = select(col(IdentityRow.id)).where(col(IdentityRow.provider) == provider)
            session.execute(delete(TokenRow).where(col(TokenRow.opened_by).in_(bound)))
            session.execute(delete(IdentityRow).where(col(IdentityRow.provider) == provider))
            for table in (PlatformScoreRow, PlatformLinkRow, PlatformPickingRow):
                session.execute(delete(table).where(col(table.platform) == row.id))
            session.delete(row)
            before = {"title": row.title, "issuer": row.issuer, "client_id": row.client_id}
            record(session, signed, "platform.remove", f"platform {row.id}", before=before)
            return True

    def of_course(self, course: str) -> tuple[Platform, ...]:
        """Return the platforms of a course, oldest first."""
        mine = select(PlatformRow).where(col(PlatformRow.course) == course)
        ordered = mine.order_by(col(PlatformRow.created_at), col(PlatformRow.id))
        return tuple(as_contract(row, Platform) for row in self._scalars(ordered))

    def set_people_url(self, platform_id: str, address: str) -> None:
        """Keep where a platform, if it is there, tells who is in its course."""
        mine = update(PlatformRow).where(col(PlatformRow.id) == platform_id)
        with self._database.writing() as session:
            session.execute(mine.values(people_url=address))

    def exist(self) -> bool:
        """Return whether any course has a platform."""
        return self._finds(select(col(PlatformRow.id)))

    def get(self, platform_id: str) -> Platform | None:
        """Return a platform."""
        row = self._get(PlatformRow, platform_id)
        return None if row is None else as_contract(row, Platform)

    def named(self, issuer: str, client_id: str = "", deployment: str = "") -> Platform | None:
        """Return the platform that calls itself so; None also where what it says fits several.

        One platform may have several deployments, each for a course. Where a login names none of them, the first
        one that was added stands for all: they have the same addresses (`add`), and the message names its own.
        """
        row, conditions = PlatformRow, [col(PlatformRow.issuer) == issuer]
        conditions += [col(row.client_id) == client_id] if client_id else []
        conditions += [col(row.deployment) == deployment] if deployment else []
        ordered = select(PlatformRow).where(*conditions).order_by(col(row.created_at), col(row.id))
        rows = self._scalars(ordered)
        is_one = len({platform.client_id for platform in rows}) == 1
        return as_contract(rows[0], Platform) if is_one else None

    def use(self, message: str, expires_at: datetime) -> bool:
        """Note that a message lets somebody in; False: it has done so before."""
        now = self._clock()
        row = UsedMessageRow(sha256=digest_of(message), expires_at=expires_at + _SKEW)
        try:
            with self._database.writing() as session:
                session.execute(delete(UsedMessageRow).where(col(UsedMessageRow.expires_at) <= now))
                session.add(row)
        except IntegrityError:
            return False
        return True

    def open_link(self, link: PlatformLink) -> PlatformLink:
        """Note that an activity was opened; return it as it is known now.

        A title or an assignment that it does not say stays as it was. Where its scores go is as it says.

        Raises RefusedError: the platform was removed meanwhile.
        """
        with self._database.writing() as session:
            _hold(session, link.platform)
            row = session.get(PlatformLinkRow, (link.platform, link.resource))
            if row is None:
                row = PlatformLinkRow(**asdict(link))
                session.add(row)
            else:
                row.title = link.title or row.title
                row.assignment = link.assignment or row.assignment
                if link.line_item != row.line_item:
                    # another column of the gradebook, which has no scores yet
                    values = (
                        col(PlatformScoreRow.platform) == link.platform,
                        col(PlatformScoreRow.resource) == link.resource,
                    )
                    session.execute(update(PlatformScoreRow).where(*values).values(sha256=""))
                row.line_item, row.used_at = link.line_item, link.used_at
            session.flush()
            return as_contract(row, PlatformLink)

    def invite(self, signed: Signature) -> str:
        """Invite a platform to the course of `signed`; return the secret by which it is added within a day."""
        secret = secrets.token_urlsafe(_SECRET_BYTES)
        row = PlatformInvitationRow(
            sha256=digest_of(secret),
            course=signed.course or "",
            actor=signed.actor,
            until=signed.at + _INVITATION,
        )
        with self._database.writing() as session:
            old = col(PlatformInvitationRow.until) <= signed.at
            session.execute(delete(PlatformInvitationRow).where(old))
            session.add(row)
            record(session, signed, "platform.invite", "platform")
        return secret

    def invited(self, secret: str) -> Signature | None:
        """Return who invited the platform that shows a secret, and where to; None if it is unknown or expired."""
        now = self._clock()
        row = self._get(PlatformInvitationRow, digest_of(secret))
        return None if row is None or row.until <= now else Signature(now, row.course, row.actor)

    def end_invitation(self, secret: str) -> bool:
        """End an invitation; return whether its secret was still valid."""
        with self._database.writing() as session:
            mine = col(PlatformInvitationRow.sha256) == digest_of(secret)
            ended = session.execute(
                delete(PlatformInvitationRow).where(mine).returning(col(PlatformInvitationRow.sha256))
            )
            return ended.first() is not None

    def open_picking(self, platform: str, subject: str, picking: Picking) -> str:
        """Let the person whom a platform calls `subject` choose within an hour; return the secret for that.

        Raises RefusedError: the platform was removed meanwhile.
        """
        secret, now = secrets.token_urlsafe(_SECRET_BYTES), self._clock()
        row = PlatformPickingRow(
            sha256=digest_of(secret),
            platform=platform,
            subject=subject,
            until=now + _PICKING,
            **asdict(picking),
        )
        with self._database.writing() as session:
            _hold(session, platform)
            session.execute(delete(PlatformPickingRow).where(col(PlatformPickingRow.until) <= now))
            session.add(row)
        return secret

    def picking(self, secret: str) -> OpenPicking | None:
        """Return the choice that is made by a secret; None: there is none, or not any more."""
        row = self._get(PlatformPickingRow, digest_of(secret))
        return None if row is None or row.until <= self._clock() else as_contract(row, OpenPicking)

    def links(self, course: str) -> tuple[PlatformLink, ...]:
        """Return the activities of a course's platforms that were opened so far, the last one first."""
        statement = (
            select(PlatformLinkRow)
            .join(PlatformRow, col(PlatformRow.id) == col(PlatformLinkRow.platform))
            .where(col(PlatformRow.course) == course)
            .order_by(col(PlatformLinkRow.used_at).desc(), col(PlatformLinkRow.resource))
        )
        return tuple(as_contract(row, PlatformLink) for row in self._scalars(statement))

    def keys(self, new_key: Callable[[], tuple[str, str]]) -> tuple[str, ...]:
        """Return the secrets of the service's keys, the one that signs first; `new_key` makes the first one.

        A newer one is only shown at first, until platforms have read it.
        """
        with self._database.reading() as session:
            keys = self._newest_keys(session)
        return tuple(row.secret for row in keys) or self._add_key(new_key, at_once=False, anew=False)

    def rotate_key(self, new_key: Callable[[], tuple[str, str]], *, at_once: bool) -> None:
        """Add a key that signs once platforms had time to read it, in place of one that nothing was signed by yet.

        at_once: it signs from now on, and no key before is good any more.
        """
        self._add_key(new_key, at_once=at_once, anew=True)

    def _add_key(
        self, new_key: Callable[[], tuple[str, str]], *, at_once: bool, anew: bool
    ) -> tuple[str, ...]:
        id_, secret = new_key()
        now, row = self._clock(), PlatformKeyRow
        with self._database.writing() as session:
            one_at_a_time(session, "platform_key")
            keys = self._newest_keys(session)
            if keys and not anew:
                return tuple(key.secret for key in keys)
            if at_once:
                session.execute(delete(row))
            elif keys:
                session.execute(delete(row).where(col(row.id) != keys[0].id))
            session.add(row(id=id_, secret=secret, created_at=now))
            return (secret,)

    def _newest_keys(self, session: Session) -> list[PlatformKeyRow]:
        """Return the key that signs, and then the one before it or the one that is to be read first."""
        ordered = select(PlatformKeyRow).order_by(col(PlatformKeyRow.created_at).desc()).limit(2)
        rows = list(session.execute(ordered).scalars())
        if len(rows) > 1 and rows[0].created_at > self._clock() - KEY_READ_WITHIN:
            rows.reverse()
        return rows


def _hold(session: Session, platform: str) -> None:
    """Lock a platform, so that nobody removes it until the transaction ends.

    Raises RefusedError: somebody has removed it.
    """
    one_at_a_time(session, "platform_link", platform)
    if session.get(PlatformRow, platform) is None:
        raise RefusedError("platform_unknown")
