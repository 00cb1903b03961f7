"""The page on which an instructor sets up notices to group chats and people."""

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Form, Query, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.contracts.notice import GROUPS, MailWishes, NewWebhook, NoticeKind, Outlet, Vendor
from grader.service.web.access import InstructorDep, PageErrand, require_staff
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.use_cases import notices

router = APIRouter(prefix="/class/notices", include_in_schema=False, dependencies=[Depends(require_staff)])
Done = Annotated[Literal["", "saved", "removed", "sent"], Query()]
Group = Annotated[Literal[Outlet.CLASS, Outlet.STAFF], Form()]


class WebhookForm(BaseModel):
    """A group's bot. What was entered is not shown again, not even beside an error."""

    outlet: Literal[Outlet.CLASS, Outlet.STAFF] = Outlet.CLASS
    vendor: Vendor = Vendor.FEISHU
    address: str = Field(default="", max_length=2_000)
    secret: str = Field(default="", max_length=1_000)


class MailForm(BaseModel):
    """What is e-mailed: boxes that are not ticked are not sent."""

    due: bool = False
    graded: bool = False
    faults: bool = False


@router.get("")
def read(errand: InstructorDep, done: Done = "") -> Response:
    """Show what is set up, and how the latest notices fared."""
    return _page(errand, done=done)


@router.post("/webhook", dependencies=OWN_FORM)
def set_webhook(errand: InstructorDep, form: Annotated[WebhookForm, Form()]) -> Response:
    """Set a group's bot."""
    new = NewWebhook(
        outlet=form.outlet, vendor=form.vendor, address=form.address.strip(), secret=form.secret.strip()
    )
    try:
        notices.set_webhook(errand.services, errand.caller, new)
    except RefusedError as error:
        return _page(errand, error=error, of=form.outlet, vendor=form.vendor)
    return _back("saved")


@router.post("/remove", dependencies=OWN_FORM)
def remove_webhook(errand: InstructorDep, outlet: Group = Outlet.CLASS) -> Response:
    """Take a group's bot away."""
    try:
        notices.remove_webhook(errand.services, errand.caller, outlet)
    except RefusedError as error:
        return _page(errand, error=error, of=outlet)
    return _back("removed")


@router.post("/test", dependencies=OWN_FORM)
def send_test(errand: InstructorDep, outlet: Annotated[Outlet, Form()] = Outlet.CLASS) -> Response:
    """Send a test message, and say what came of it."""
    try:
        notices.send_test(errand.services, errand.caller, outlet)
    except RefusedError as error:
        return _page(errand, error=error, of=outlet)
    return _back("sent")


@router.post("/mail", dependencies=OWN_FORM)
def set_mail(errand: InstructorDep, form: Annotated[MailForm, Form()]) -> Response:
    """Choose what is e-mailed."""
    try:
        notices.set_mail(errand.services, errand.caller, MailWishes(**form.model_dump()))
    except RefusedError as error:
        return _page(errand, error=error, of=Outlet.MAIL)
    return _back("saved")


def _back(done: str) -> Response:
    return RedirectResponse(f"/class/notices?done={done}", status_code=303)


def _page(
    errand: PageErrand,
    *,
    error: RefusedError | None = None,
    of: Outlet | None = None,
    vendor: Vendor = Vendor.FEISHU,
    done: str = "",
) -> Response:
    problem = None if error is None else form_problem(error, errand.language)
    return page(
        errand.request,
        "notices.html",
        status=200 if problem is None else problem.status,
        setup=notices.setup_of(errand.services, errand.caller),
        groups=GROUPS,
        vendors=tuple(Vendor),
        kinds=tuple(NoticeKind),
        problem=problem,
        problem_of=of,
        vendor=vendor,
        done=done,
    )
