"""What learning platforms open (LTI 1.3), and the page on which an instructor sets one up.

A platform sends the browser back with a form, which is a request from another site. A cookie ties the form to the
login that this browser began; without ``SameSite=None`` the browser would not send it with such a form. In a frame
browsers may block the cookie, so there a page offers to open the service in a window of its own.
"""

from typing import Annotated, Any
from urllib.parse import urlencode

from fastapi import APIRouter, Depends, Form, Request, Response
from fastapi.responses import JSONResponse, RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Seen
from grader.contracts.platform import NewPlatform
from grader.outside.lti import Kept
from grader.service.web.access import InstructorDep, PageErrand, ServicesDep, require_staff
from grader.service.web.errors import FRAMES, form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.service.web.picking import PICK, framed_by, lead_to, set_cookie
from grader.service.web.signing_in import arrived, kept_by
from grader.use_cases import platform_people, platforms, registering

router = APIRouter(prefix="/lti", include_in_schema=False)
desk = APIRouter(prefix="/class/platforms", include_in_schema=False, dependencies=[Depends(require_staff)])
COOKIE = "grader_lti"
_PATIENCE_S = 600
_LONGEST = 2_000
_LOGIN_FIELDS = ("iss", "login_hint", "lti_message_hint", "client_id", "lti_deployment_id", "target_link_uri")
_LONGEST_TOKEN = 64 * 1024
_OURS = {
    "tool_url": "/",
    "initiate_url": "/lti/login",
    "keys_url": "/lti/keys",
    "redirect_url": "/lti/launch",
    "pick_url": PICK,
}
"""The addresses that an instructor copies into the platform, by the last part of the id of their label."""
PlatformId = Annotated[str, Form(max_length=16)]


class PlatformForm(BaseModel):
    """What an instructor copies from the platform."""

    title: str = Field(default="", max_length=200)
    issuer: str = Field(default="", max_length=255)
    client_id: str = Field(default="", max_length=255)
    deployment: str = Field(default="", max_length=255)
    login_url: str = Field(default="", max_length=1_000)
    token_url: str = Field(default="", max_length=1_000)
    keys_url: str = Field(default="", max_length=1_000)

    def stripped(self) -> NewPlatform:
        """Return the platform, without blanks around its fields."""
        return NewPlatform(**{name: value.strip() for name, value in self.model_dump().items()})


@router.get("/login")
def login_by_get(request: Request, services: ServicesDep) -> Response:
    """Begin a login: redirect the browser to the platform, which says who it is."""
    return _login(request, services, dict(request.query_params))


@router.post("/login")
async def login(request: Request, services: ServicesDep) -> Response:
    """Do the same for a POST, which platforms may use as well."""
    fields = await request.form(max_files=0, max_fields=50)
    return _login(request, services, {name: str(value) for name, value in fields.items()})


@router.get("/keys")
def keys(services: ServicesDep) -> Response:
    """Return the keys by which platforms check what the service sends."""
    return JSONResponse(platforms.public_keys(services), headers={"Cache-Control": "public, max-age=3600"})


@router.post("/launch")
def launch(
    request: Request,
    services: ServicesDep,
    id_token: Annotated[str, Form(max_length=_LONGEST_TOKEN)] = "",
    state: Annotated[str, Form(max_length=_LONGEST)] = "",
    error: Annotated[str, Form(max_length=_LONGEST)] = "",
) -> Response:
    """Finish a login: sign in the person whom the platform names, and open the activity."""
    kept = kept_by(request.cookies.get(COOKIE, "")[:_LONGEST], ("state", "nonce"), state)
    if error or not id_token:
        raise RefusedError("signin_refused")
    went = Kept(platform=kept.get("platform", ""), state=kept["state"], nonce=kept["nonce"])
    came = platforms.finish(services, went, id_token)
    if came.picking:
        return lead_to(request, came.picking)
    response = arrived(request, came.arrival, f"/assignments/{came.assignment}" if came.assignment else "/")
    response.delete_cookie(COOKIE, path="/lti", httponly=True, secure=True, samesite="none")
    return response


@desk.get("")
def read(errand: InstructorDep) -> Response:
    """Show the course's platforms and how to add one."""
    return _desk(errand)


@desk.post("", dependencies=OWN_FORM)
def add(errand: InstructorDep, form: Annotated[PlatformForm, Form()]) -> Response:
    """Add a platform, or show the form again with what is wrong."""
    try:
        platforms.add_platform(errand.services, errand.caller, form.stripped())
    except RefusedError as error:
        problem = form_problem(error, errand.language)
        return _desk(errand, form, problem=problem)
    return RedirectResponse("/class/platforms", status_code=303)


@desk.post("/invite", dependencies=OWN_FORM)
def invite(errand: InstructorDep) -> Response:
    """Show an address by which the platform adds itself."""
    return _desk(errand, invitation=registering.invite(errand.services, errand.caller))


@desk.post("/remove", dependencies=OWN_FORM)
def remove(errand: InstructorDep, platform: PlatformId = "") -> Response:
    """Take a platform away."""
    platforms.remove_platform(errand.services, errand.caller, platform)
    return RedirectResponse("/class/platforms", status_code=303)


@desk.post("/people", dependencies=OWN_FORM)
def preview_people(errand: InstructorDep, platform: PlatformId = "") -> Response:
    """Ask the platform who is in its course, and show whom that would add."""
    return _people(errand, platform)


@desk.post("/people/add", dependencies=OWN_FORM)
def add_people(
    errand: InstructorDep, seen: Annotated[str, Form(max_length=64)], platform: PlatformId = ""
) -> Response:
    """Add the people that the instructor was shown; if the list has changed meanwhile, show the new one."""
    try:
        platform_people.add(errand.services, errand.caller, platform, Seen.one(seen))
    except RefusedError as error:
        if error.code == "changed_meanwhile":
            return _people(errand, platform, meanwhile=True)
        return _desk(errand, problem=form_problem(error, errand.language))
    return RedirectResponse("/class/people?done=imported", status_code=303)


def _people(errand: PageErrand, platform: str, *, meanwhile: bool = False) -> Response:
    try:
        plan = platform_people.plan(errand.services, errand.caller, platform)
    except RefusedError as error:
        return _desk(errand, problem=form_problem(error, errand.language))
    return page(errand.request, "platform_people.html", plan=plan, meanwhile=meanwhile)


def _login(request: Request, services: ServicesDep, said: dict[str, str]) -> Response:
    asked = {name: said[name] for name in _LOGIN_FIELDS if name in said and len(said[name]) <= _LONGEST}
    kept, address = platforms.begin(services, asked)
    framed = request.headers.get("sec-fetch-dest") in FRAMES
    picks = asked.get("target_link_uri") == f"{services.providers.public_url}{PICK}"
    if framed and not picks:  # what is chosen must be brought back from where it was asked for
        shown = page(request, "lti_window.html", address=f"/lti/login?{urlencode(asked)}")
        return framed_by(shown, asked["iss"], address)
    response = RedirectResponse(address, status_code=303)
    value = urlencode({"platform": kept.platform, "state": kept.state, "nonce": kept.nonce})
    set_cookie(request, response, COOKIE, value, path="/lti", patience_s=_PATIENCE_S)
    return response


def _desk(errand: PageErrand, form: PlatformForm | None = None, **shown: Any) -> Response:
    public_url, problem = errand.services.providers.public_url, shown.get("problem")
    return page(
        errand.request,
        "platforms.html",
        status=200 if problem is None else problem.status,
        platforms=platforms.platforms_of(errand.services, errand.caller),
        links=platforms.links_of(errand.services, errand.caller),
        form=form or PlatformForm(),
        **{"problem": None, "invitation": "", **shown},
        ours={name: f"{public_url}{path}" for name, path in _OURS.items()} if public_url else {},
        troubles=platforms.troubles_of(errand.services, errand.caller),
    )
