"""What the course's group chats are told, and what people are told by e-mail."""

from datetime import datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Path, Response, status
from pydantic import ConfigDict, Field, StrictBool

from grader.contracts.notice import MailWishes, NewWebhook, NoticeKind, Outlet, Vendor
from grader.service.requests.answers import PRIVATE
from grader.service.requests.dependencies import InstructorDep
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import notices
from grader.use_cases.bodies import Body

router = APIRouter(prefix="/api/v1/course/notices", tags=["course"])
_ON_READ = ("forbidden", "no_course", "invalid_request")
_ON_CHANGE = (*_ON_READ, "course_archived", "malformed_body", "too_large")
Group = Annotated[Literal[Outlet.CLASS, Outlet.STAFF], Path(description="Whose group chat it is.")]
AnyChannel = Annotated[Outlet, Path(description="A group chat, or the caller's own e-mail address.")]


class WebhookBody(Body):
    """The bot of a group chat."""

    model_config = ConfigDict(hide_input_in_errors=True)

    vendor: Vendor = Field(examples=["feishu"])
    address: str = Field(
        max_length=1_000,
        description="As the bot's page shows it; never shown again.",
        examples=["https://open.feishu.cn/open-apis/bot/v2/hook/…"],
    )
    secret: str = Field(
        default="",
        max_length=200,
        description="By which messages are signed; WeCom has none. Never shown again.",
    )


class WebhookView(View):
    """The bot of a group chat, without what lets others speak there."""

    outlet: Outlet = Field(examples=["class"])
    vendor: Vendor = Field(examples=["feishu"])
    host: str = Field(examples=["open.feishu.cn"])
    signed: bool
    changed_at: datetime


class MailBody(Body):
    """What is e-mailed."""

    due: StrictBool = Field(description="A day before, to students who have handed nothing in.")
    graded: StrictBool = Field(description="To students, what counts of theirs.")
    faults: StrictBool = Field(description="To instructors, what the service failed to grade.")


class NoticeView(View):
    """A notice, without what it says."""

    outlet: Outlet
    kind: NoticeKind
    person: str = Field(description="Who gets it; empty: a group.", examples=[""])
    made_at: datetime
    sent_at: datetime | None = Field(description="Null: not yet, or given up.")
    waits: bool = Field(description="It is still to be sent.")
    not_before: datetime = Field(description="When it is tried again.")
    tries: int = Field(description="Failed ones.", examples=[0])
    code: str = Field(description="Why the latest failed; empty: none did.", examples=["security"])
    trouble: str = Field(description="What the other side said.", examples=["200, 19021: sign match fail"])


class NoticesView(View):
    """What is set up, and the latest notices."""

    webhooks: list[WebhookView]
    mail: MailBody
    can_mail: bool = Field(description="The operator has set up a mail server.")
    latest: list[NoticeView] = Field(description="Newest first.")


@router.get("", summary="What the course tells by itself", responses=responses(*_ON_READ))
def read_notices(errand: InstructorDep, response: Response) -> NoticesView:
    """Return where notices go and how the latest fared."""
    response.headers.update(PRIVATE)
    setup = notices.setup_of(errand.services, errand.caller)
    latest = [NoticeView.of(notice, waits=bool(notice.body)) for notice in setup.latest]
    return NoticesView.of(setup, webhooks=list(setup.webhooks.values()), latest=latest)


@router.put(
    "/webhooks/{outlet}",
    summary="Set a group's bot",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(*_ON_CHANGE, "invalid_webhook"),
)
def put_webhook(errand: InstructorDep, outlet: Group, body: WebhookBody) -> None:
    """Let a bot of Feishu, DingTalk or WeCom speak in a group; in place of the one before."""
    new = NewWebhook(
        outlet=outlet, vendor=body.vendor, address=body.address.strip(), secret=body.secret.strip()
    )
    notices.set_webhook(errand.services, errand.caller, new)


@router.delete(
    "/webhooks/{outlet}",
    summary="Remove a group's bot",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(*_ON_READ, "webhook_not_found"),
)
def delete_webhook(errand: InstructorDep, outlet: Group) -> None:
    """Send nothing there any more."""
    notices.remove_webhook(errand.services, errand.caller, outlet)


@router.put(
    "/mail",
    summary="Choose what is e-mailed",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(*_ON_CHANGE, "mail_not_set_up"),
)
def put_mail(errand: InstructorDep, body: MailBody) -> None:
    """Send e-mail to those of the class list who have an address there."""
    notices.set_mail(errand.services, errand.caller, MailWishes(**body.model_dump()))


@router.post(
    "/{outlet}/test",
    summary="Send a test message",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(
        *_ON_READ, "webhook_not_found", "mail_not_set_up", "no_own_address", "notice_not_taken"
    ),
)
def send_test(errand: InstructorDep, outlet: AnyChannel) -> None:
    """Try a group's bot, or e-mail to oneself, now; the answer says what the other side said."""
    notices.send_test(errand.services, errand.caller, outlet)
