"""What the service says by itself: to group chats by their bots' webhooks, and to people by e-mail."""

from dataclasses import dataclass, field
from datetime import datetime

from grader.contracts.python import StrEnum


class Outlet(StrEnum):
    """Where notices of a course go. A group's webhook is called as its outlet."""

    CLASS = "class"
    STAFF = "staff"
    MAIL = "mail"


GROUPS = (Outlet.CLASS, Outlet.STAFF)
"""The outlets that are group chats: no notice there names a student or says what somebody reached."""


class Vendor(StrEnum):
    """Whose bots a webhook belongs to."""

    FEISHU = "feishu"
    DINGTALK = "dingtalk"
    WECOM = "wecom"


class NoticeKind(StrEnum):
    """What a notice is about."""

    DUE = "due"
    GRADED = "graded"
    FAULTS = "faults"


@dataclass(frozen=True, slots=True, kw_only=True)
class NewWebhook:
    """A group's bot.

    Attributes:
        address: where it takes messages, with the bot's key in it: a secret.
        secret: by which messages are signed; empty: they are not.
    """

    outlet: Outlet
    vendor: Vendor
    address: str = field(repr=False)
    secret: str = field(repr=False, default="")


@dataclass(frozen=True, slots=True, kw_only=True)
class Webhook(NewWebhook):
    """A group's bot of a course."""

    course: str
    changed_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class MailWishes:
    """What a course has e-mailed.

    Attributes:
        due: to students who have handed nothing in a day before. graded: to students, what counts of theirs.
        faults: to instructors.
    """

    due: bool = False
    graded: bool = False
    faults: bool = False

    def __bool__(self) -> bool:
        return self.due or self.graded or self.faults


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """A notice to be sent, unless what it tells is known to have been told.

    Attributes:
        person: who gets it; empty: a group.
        body: empty: nothing is sent, what it tells counts as told.
        until: it is not sent later, because nobody needs it then.
        told: by subject the state that it tells of.
    """

    outlet: Outlet
    kind: NoticeKind
    person: str = ""
    heading: str = ""
    body: str = ""
    until: datetime
    told: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Notice:
    """A notice of a course.

    Attributes:
        body: empty once it was sent, or is given up.
        sent_at: None: not yet. not_before: nobody sends it before. until: nobody sends it later.
        tries: failed so far. code, trouble: of the latest failure (`NotSentError`); empty: none.
    """

    id: str
    course: str
    outlet: Outlet
    kind: NoticeKind
    person: str
    heading: str
    body: str
    made_at: datetime
    until: datetime
    not_before: datetime
    sent_at: datetime | None
    tries: int
    code: str
    trouble: str
