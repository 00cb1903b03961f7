"""Notices: where a course wants them, what is to be sent, and which states they reported.

The state that a notice reports is stored in the transaction that adds the notice. So it is added once, even if two
processes look at the same time, or one dies and looks again. A process claims a notice before it sends it. If it
dies before it has noted that, the notice is sent once more, after `PATIENCE`.
"""

import secrets
from collections.abc import Iterable
from datetime import datetime, timedelta
from typing import Any
from urllib.parse import urlsplit

from sqlalchemy import delete, func, select, update
from sqlmodel import Session, col

from grader.contracts.identity import Role
from grader.contracts.notice import (
    Draft,
    MailWishes,
    NewWebhook,
    Notice,
    NoticeKind,
    Outlet,
    Vendor,
    Webhook,
)
from grader.contracts.submission import SubmissionState
from grader.store.audit import Signature, record
from grader.store.clock import TimedPart, ahead, longer_pause
from grader.store.database import one_at_a_time
from grader.store.tables import (
    CourseRow,
    MailWishesRow,
    MemberRow,
    NoticeRow,
    SubmissionRow,
    ToldRow,
    WebhookRow,
    as_contract,
)

PATIENCE = timedelta(minutes=2)
"""As long as one process may take for one notice before another sends it, too."""

_FIRST_PAUSE_S = 60.0
_KEPT = timedelta(days=30)
_ID_BYTES = 16
_MOST_AT_ONCE = 60
_LONGEST_TROUBLE = 500
_NO_WISHES = MailWishes()


class Notices(TimedPart):
    """Keeps notices; safe to share between threads and processes."""

    def courses(self) -> tuple[str, ...]:
        """Return the courses that want notices and are taught."""
        row = MailWishesRow
        mailing = select(col(row.course)).where(col(row.due) | col(row.graded) | col(row.faults))
        notified = select(col(WebhookRow.course)).union(mailing)
        taught = select(col(CourseRow.id)).where(
            col(CourseRow.id).in_(notified), col(CourseRow.archived_at).is_(None)
        )
        return tuple(self._scalars(taught.order_by(col(CourseRow.id))))

    def webhooks(self, course: str) -> dict[Outlet, Webhook]:
        """Return the webhooks of a course by outlet."""
        mine = select(WebhookRow).where(col(WebhookRow.course) == course).order_by(col(WebhookRow.outlet))
        return {webhook.outlet: webhook for webhook in map(_webhook, self._scalars(mine))}

    def wishes(self, course: str) -> MailWishes:
        """Return what a course has e-mailed."""
        row = self._get(MailWishesRow, course)
        return _NO_WISHES if row is None else as_contract(row, MailWishes)

    def set_webhook(self, new: NewWebhook, signed: Signature) -> None:
        """Make `new` the webhook of its outlet in the course of `signed`; what waits for it is sent there soon.

        Raises RefusedError: the course is archived.
        """
        course = signed.course or ""
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            kept = session.get(WebhookRow, (course, new.outlet.value))
            values = {"vendor": new.vendor.value, "address": new.address, "secret": new.secret}
            row = WebhookRow(course=course, outlet=new.outlet.value, changed_at=signed.at, **values)
            before = None if kept is None else _audited(kept)
            session.merge(row)
            waiting = _waiting(course, new.outlet)
            session.execute(update(NoticeRow).where(*waiting).values(not_before=signed.at))
            record(
                session,
                signed,
                "webhook.set",
                f"webhook {new.outlet.value}",
                before=before,
                after=_audited(row),
            )

    def remove_webhook(self, outlet: Outlet, signed: Signature) -> bool:
        """Take a webhook away, and what waits for it, if it is there."""
        course = signed.course or ""
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            row = session.get(WebhookRow, (course, outlet.value))
            if row is None:
                return False
            before = _audited(row)
            session.delete(row)
            session.execute(delete(NoticeRow).where(*_waiting(course, outlet)))
            record(session, signed, "webhook.remove", f"webhook {outlet.value}", before=before)
            return True

    def set_wishes(self, wishes: MailWishes, signed: Signature) -> None:
        """Choose what the course of `signed` has e-mailed; what waits and is not wanted any more is not sent.

        Raises RefusedError: the course is archived.
        """
        course = signed.course or ""
        after = {kind.value: getattr(wishes, kind.value) for kind in NoticeKind}
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            row = session.get(MailWishesRow, course)
            before = {kind.value: row is not None and getattr(row, kind.value) for kind in NoticeKind}
            if before == after:
                return
            session.merge(MailWishesRow(course=course, changed_at=signed.at, **after))
            unwanted = [name for name, is_wanted in after.items() if not is_wanted]
            waiting = *_waiting(course, Outlet.MAIL), col(NoticeRow.kind).in_(unwanted)
            session.execute(delete(NoticeRow).where(*waiting))
            record(session, signed, "mail.set", f"course {course}", before=before, after=after)

    def notified_states(self, course: str, outlet: Outlet) -> dict[tuple[str, str], str]:
        """Return the states that notices have been made of, by person and subject."""
        mine = select(ToldRow).where(col(ToldRow.course) == course, col(ToldRow.outlet) == outlet.value)
        return {(row.person, row.about): row.state for row in self._scalars(mine)}

    def made_since(self, course: str, since: datetime) -> dict[tuple[Outlet, NoticeKind, str], datetime]:
        """Return by outlet, kind and person when the latest notice was made, of those made since."""
        row = NoticeRow
        lately = col(row.made_at) > since, col(row.made_at) <= self._clock()
        mine = select(NoticeRow).where(col(row.course) == course, *lately).order_by(col(row.made_at))
        rows = self._scalars(mine)
        return {
            (Outlet(notice.outlet), NoticeKind(notice.kind), notice.person): notice.made_at for notice in rows
        }

    def add(self, course: str, drafts: Iterable[Draft]) -> int:
        """Add what is to be sent, in one transaction; return how many notices that are.

        A draft that tells of a state that was told of meanwhile is left out: the next look makes a new one. So is
        one to who has left.
        """
        now, added = self._clock(), 0
        with self._database.writing() as session:
            one_at_a_time(session, "course", course)
            members = select(col(MemberRow.person)).where(col(MemberRow.course) == course)
            people = {"", *session.execute(members).scalars()}  # groups are nobody
            for draft in drafts:
                if draft.person in people and _note(session, course, draft) and draft.body:
                    session.add(_row(course, draft, now))
                    added += 1
            old = col(NoticeRow.course) == course, col(NoticeRow.made_at) < now - _KEPT
            session.execute(delete(NoticeRow).where(*old))
        return added

    def give_up(self) -> int:
        """Forget the words of notices that nobody needs any more; return how many these are."""
        row, now = NoticeRow, self._clock()
        late = col(row.sent_at).is_(None), col(row.body) != "", col(row.until) <= now
        if not self._finds(select(col(row.id)).where(*late)):
            return 0
        with self._database.writing() as session:
            given_up = update(NoticeRow).where(*late).values(body="").returning(col(row.id))
            return len(session.execute(given_up).all())

    def waiting(self) -> tuple[Notice, ...]:
        """Return notices that are to be sent now, oldest first; not all if there are many."""
        row, now = NoticeRow, self._clock()
        mine = col(row.sent_at).is_(None), col(row.body) != "", ~ahead(col(row.not_before), now)
        taught = col(CourseRow.archived_at).is_(None)
        statement = (
            select(NoticeRow)
            .join(CourseRow, col(CourseRow.id) == col(row.course))
            .where(*mine, taught)
            .order_by(col(row.made_at), col(row.id))
            .limit(_MOST_AT_ONCE)
        )
        return tuple(_notice(one) for one in self._scalars(statement))

    def claim(self, notice_id: str) -> Notice | None:
        """Take it on to send a notice; None: another process does, or has, or it is too early or too late."""
        now = self._clock()
        with self._database.writing() as session:
            row = session.get(NoticeRow, notice_id, with_for_update=True)
            if row is None or row.sent_at is not None or not row.body:
                return None
            if ahead(row.not_before, now) or row.until <= now:
                return None
            row.not_before = now + PATIENCE
            return _notice(row)

    def sent(self, notice: Notice) -> None:
        """Note that a notice was taken; its words are kept no longer."""
        self._note(notice, sent_at=self._clock(), body="", code="", trouble="")

    def drop(self, notice: Notice) -> None:
        """Note that there is nobody to send it to."""
        with self._database.writing() as session:
            session.execute(delete(NoticeRow).where(col(NoticeRow.id) == notice.id))

    def failed(
        self, notice: Notice, code: str, trouble: str, *, least_pause_s: float = 0.0, alone: bool = False
    ) -> None:
        """Note that a notice was not taken: the pause until the next try doubles.

        Others of its outlet wait as long, unless the failure is of this one `alone`: e-mail of all courses goes
        by one server.
        """
        tries = notice.tries + 1
        later = self._clock() + max(longer_pause(_FIRST_PAUSE_S, tries), timedelta(seconds=least_pause_s))
        row = NoticeRow
        self._note(notice, not_before=later, tries=tries, code=code, trouble=trouble[:_LONGEST_TROUBLE])
        if alone:
            return
        others = [col(row.outlet) == notice.outlet.value, col(row.sent_at).is_(None)]
        others += [] if notice.outlet is Outlet.MAIL else [col(row.course) == notice.course]
        with self._database.writing() as session:
            waits = update(NoticeRow).where(*others, col(row.not_before) < later)
            session.execute(waits.values(not_before=later))

    def latest(self, course: str, limit: int) -> tuple[Notice, ...]:
        """Return notices of a course, newest first."""
        row = NoticeRow
        mine = select(NoticeRow).where(col(row.course) == course)
        newest = mine.order_by(col(row.made_at).desc(), col(row.id)).limit(limit)
        return tuple(_notice(one) for one in self._scalars(newest))

    def graded_between(self, course: str, since: datetime, until: datetime) -> dict[str, tuple[int, int]]:
        """Return by assignment how many submissions of how many students were graded then; not trials."""
        row, member = SubmissionRow, MemberRow
        students = select(col(member.person)).where(
            col(member.course) == course, col(member.role) == Role.STUDENT.value
        )
        counts = func.count(), func.count(col(row.student).distinct())
        statement = select(col(row.assignment), *counts).where(
            col(row.course) == course,
            col(row.student).in_(students),
            col(row.regrade).is_(None),
            col(row.state) == SubmissionState.GRADED.value,
            col(row.finished_at) >= since,
            col(row.finished_at) < until,
        )
        rows = self._rows(statement.group_by(col(row.assignment)))
        return {assignment: (submissions, people) for assignment, submissions, people in rows}

    def given_up_since(self, course: str, since: datetime) -> dict[str, tuple[str, int]]:
        """Return by submission its assignment and number of claims, where the service failed to grade it."""
        row = SubmissionRow
        statement = select(col(row.id), col(row.assignment), col(row.attempt)).where(
            col(row.course) == course,
            col(row.regrade).is_(None),
            col(row.state) == SubmissionState.INFRASTRUCTURE_ERROR.value,
            col(row.finished_at) >= since,
        )
        return {id_: (of, attempt) for id_, of, attempt in self._rows(statement)}

    def _note(self, notice: Notice, **values: object) -> None:
        with self._database.writing() as session:
            session.execute(update(NoticeRow).where(col(NoticeRow.id) == notice.id).values(**values))


def _waiting(course: str, outlet: Outlet) -> tuple[Any, ...]:
    row = NoticeRow
    return col(row.course) == course, col(row.outlet) == outlet.value, col(row.sent_at).is_(None)


def _note(session: Session, course: str, draft: Draft) -> bool:
    """Note what a draft tells of; return whether all of it is new."""
    rows = {
        about: session.get(ToldRow, (course, draft.outlet.value, draft.person, about)) for about in draft.told
    }
    if any(row is not None and row.state == draft.told[about] for about, row in rows.items()):
        return False
    for about, row in rows.items():
        if row is None:
            key = {"course": course, "outlet": draft.outlet.value, "person": draft.person, "about": about}
            session.add(ToldRow(**key, state=draft.told[about]))
        else:
            row.state = draft.told[about]
    return True


def _row(course: str, draft: Draft, now: datetime) -> NoticeRow:
    return NoticeRow(
        id=secrets.token_hex(_ID_BYTES),
        course=course,
        outlet=draft.outlet.value,
        kind=draft.kind.value,
        person=draft.person,
        heading=draft.heading,
        body=draft.body,
        made_at=now,
        until=draft.until,
        not_before=now,
    )


def _notice(row: NoticeRow) -> Notice:
    return as_contract(row, Notice, outlet=Outlet(row.outlet), kind=NoticeKind(row.kind))


def _webhook(row: WebhookRow) -> Webhook:
    return as_contract(row, Webhook, outlet=Outlet(row.outlet), vendor=Vendor(row.vendor))


def _audited(row: WebhookRow) -> dict[str, object]:
    """Return what may be written down of a webhook: no key and no secret."""
    return {"vendor": row.vendor, "host": urlsplit(row.address).netloc, "signed": bool(row.secret)}
