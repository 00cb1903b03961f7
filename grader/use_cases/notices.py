"""Setting up notices: the webhooks of group bots, e-mail, and a message to test them."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from urllib.parse import urlsplit

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.contracts.notice import MailWishes, NewWebhook, Notice, NoticeKind, Outlet, Vendor
from grader.contracts.text import Text
from grader.messages import on_page, say
from grader.outside.notices import NotSentError
from grader.outside.notices.bots import example_address, is_address
from grader.outside.notices.mail import Letter
from grader.use_cases.callers import taught_course
from grader.use_cases.notice_writing import count_as_told
from grader.use_cases.services import Services

_LONGEST_ADDRESS, _LONGEST_SECRET = 1_000, 200
_SHOWN = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownWebhook:
    """A webhook without its secrets. `signed`: messages carry a signature."""

    outlet: Outlet
    vendor: Vendor
    host: str
    signed: bool
    changed_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What a course has set up.

    Attributes:
        can_mail: the operator has set up a mail server.
        latest: the latest notices, newest first, without their texts.
    """

    webhooks: Mapping[Outlet, ShownWebhook]
    mail: MailWishes
    can_mail: bool
    latest: tuple[Notice, ...]


def setup_of(services: Services, caller: Caller) -> Setup:
    """Return what the caller's course has set up. For instructors of a course."""
    course = taught_course(caller)
    webhooks = services.notices.webhooks(course).values()
    return Setup(
        webhooks={
            webhook.outlet: ShownWebhook(
                outlet=webhook.outlet,
                vendor=webhook.vendor,
                host=urlsplit(webhook.address).netloc,
                signed=bool(webhook.secret),
                changed_at=webhook.changed_at,
            )
            for webhook in webhooks
        },
        mail=services.notices.wishes(course),
        can_mail=services.mail is not None,
        latest=services.notices.latest(course, _SHOWN),
    )


def set_webhook(services: Services, caller: Caller, new: NewWebhook) -> None:
    """Send the notices of the caller's course to a group chat, by the webhook of its bot.

    Raises:
        RefusedError: the caller is no instructor, there is no course, or address or secret do not fit the vendor.
    """
    course = taught_course(caller)
    if len(new.address) > _LONGEST_ADDRESS or not is_address(new.vendor, new.address):
        example = example_address(new.vendor)
        detail = Text(zh=f"地址应当像 {example}。", en=f"The address must look like {example}.")
        raise RefusedError("invalid_webhook", detail, field="address")
    printable = len(new.secret) <= _LONGEST_SECRET and new.secret.isprintable()
    if not printable or (new.secret and new.vendor is Vendor.WECOM):
        raise RefusedError("invalid_webhook", field="secret")
    if new.outlet not in services.notices.webhooks(course):
        count_as_told(services, course, new.outlet, MailWishes())
    services.notices.set_webhook(new, services.signature(caller))


def remove_webhook(services: Services, caller: Caller, outlet: Outlet) -> None:
    """Send no more notices to a group chat.

    Raises RefusedError: the caller is no instructor, or there is no such webhook.
    """
    taught_course(caller)
    if not services.notices.remove_webhook(outlet, services.signature(caller)):
        raise RefusedError("webhook_not_found")


def set_mail(services: Services, caller: Caller, wishes: MailWishes) -> None:
    """Choose which notices of the caller's course are sent by e-mail.

    Raises RefusedError: the caller is no instructor, there is no course, or no e-mail can be sent.
    """
    course = taught_course(caller)
    if wishes and services.mail is None:
        raise RefusedError("mail_not_set_up")
    before = services.notices.wishes(course)
    new = {kind.value: getattr(wishes, kind) and not getattr(before, kind) for kind in NoticeKind}
    count_as_told(services, course, None, MailWishes(**new))
    services.notices.set_wishes(wishes, services.signature(caller))


def send_test(services: Services, caller: Caller, outlet: Outlet) -> None:
    """Send a test message to a group, or to the caller's own address.

    Raises:
        RefusedError: the caller is no instructor, the outlet is not set up, it refused the message, or there were
            too many tests.
    """
    course = taught_course(caller)
    language = services.settings.default_language
    heading = on_page(language, "notices.test.heading", course=services.courses.get(course).title)
    body = on_page(language, "notices.test.body")
    services.allowances.tests.take(course)
    try:
        if outlet is Outlet.MAIL:
            _mail_test(services, caller, course, heading, body)
        else:
            webhook = services.notices.webhooks(course).get(outlet)
            if webhook is None:
                raise RefusedError("webhook_not_found")
            services.bots.send(webhook, f"{heading}\n{body}")
    except NotSentError as error:
        why = say(f"page.notices.failure.{error.code}")
        detail = Text(zh=f"{why.zh}（{error.detail}）", en=f"{why.en} ({error.detail})")
        raise RefusedError("notice_not_taken", detail) from None


def _mail_test(services: Services, caller: Caller, course: str, heading: str, body: str) -> None:
    if services.mail is None:
        raise RefusedError("mail_not_set_up")
    member = services.courses.member(course, caller.person or "")
    if member is None or not member.email:
        raise RefusedError("no_own_address")
    now = services.clock()
    id_ = f"test-{int(now.timestamp() * 1000)}"
    services.mail.send(Letter(id=id_, to=member.email, heading=heading, body=body, at=now))
