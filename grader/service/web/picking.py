"""The page on which an instructor chooses what a learning platform makes activities of (LTI Deep Linking).

Platforms show it in a frame of their own page. No session of ours goes there: the secret in its address says who
it is for (`grader.use_cases.picking`), and nothing else of the site can be framed. A token is taken in the browser
alone in which the platform opened it: nobody's own account there is bound to the token of who follows a link.
"""

import hmac
from typing import Annotated
from urllib.parse import urlsplit

from fastapi import APIRouter, Form, Path, Request, Response
from fastapi.responses import RedirectResponse

from grader.contracts.errors import RefusedError
from grader.messages import on_page
from grader.service.web.access import ServicesDep, language_of
from grader.service.web.errors import FRAMES, form_problem
from grader.service.web.pages import page
from grader.use_cases import picking

PICK = "/lti/pick"
OPENED = "grader_pick"
router = APIRouter(prefix=PICK, include_in_schema=False)
Secret = Annotated[str, Path(min_length=43, max_length=43)]
_POLICY = "Content-Security-Policy"
_MOST_CHOSEN = 500
_PATIENCE_S = 3_600


@router.get("/{secret}")
def read(request: Request, services: ServicesDep, secret: Secret) -> Response:
    """Show what there is to choose, or ask for a token."""
    return _shown(request, services, secret)


@router.post("/{secret}/token")
def show_token(
    request: Request,
    services: ServicesDep,
    secret: Secret,
    token: Annotated[str, Form(max_length=1_000)] = "",
) -> Response:
    """Note who it is that chooses, this once."""
    _require_opened_here(request, secret)
    if not picking.show_token(services, secret, token.strip()):
        wrong = on_page(language_of(request), "enter.wrong_token")
        return _shown(request, services, secret, wrong, status=403)
    return RedirectResponse(f"{PICK}/{secret}", status_code=303)


@router.post("/{secret}")
def choose(
    request: Request,
    services: ServicesDep,
    secret: Secret,
    assignment: Annotated[list[str], Form(max_length=_MOST_CHOSEN)] = [],  # noqa: B006 - a form's default
) -> Response:
    """Send the browser back to the platform with the choice."""
    language = language_of(request)
    try:
        answer = picking.choose(services, secret, assignment, language)
    except RefusedError as error:
        if error.code != "nothing_picked":
            raise
        problem = form_problem(error, language)
        return _shown(request, services, secret, f"{problem.title} {problem.fix}", status=problem.status)
    shown = page(request, "lti_picked.html", back=answer.back, message=answer.message)
    policy = shown.headers[_POLICY].replace("form-action 'self'", f"form-action {_origin(answer.back)}")
    shown.headers[_POLICY] = policy
    return framed_by(shown, answer.back)


def lead_to(request: Request, secret: str) -> Response:
    """Redirect a browser that a platform sent to the page of the choice."""
    path = f"{PICK}/{secret}"
    response = RedirectResponse(path, status_code=303)
    set_cookie(request, response, OPENED, secret, path=path, patience_s=_PATIENCE_S)
    return response


def set_cookie(  # noqa: PLR0913
    request: Request, response: Response, name: str, value: str, *, path: str, patience_s: int
) -> None:
    """Set a response's only cookie, which browsers also send with requests from other sites and in frames."""
    response.set_cookie(
        name, value, max_age=patience_s, path=path, httponly=True, secure=True, samesite="none"
    )
    if request.headers.get("sec-fetch-dest") in FRAMES:
        # a cookie for this site within that page, which also those browsers keep that block cookies of other sites
        response.headers["Set-Cookie"] += "; Partitioned"


def framed_by(response: Response, *addresses: str) -> Response:
    """Allow pages of the sites of `addresses` to show a response in a frame."""
    framed = " ".join(dict.fromkeys(map(_origin, addresses)))
    policy = response.headers[_POLICY]
    response.headers[_POLICY] = policy.replace("frame-ancestors 'none'", f"frame-ancestors {framed}")
    return response


def _shown(
    request: Request, services: ServicesDep, secret: str, problem: str = "", *, status: int = 200
) -> Response:
    desk = picking.desk_of(services, secret)
    if not desk.known:
        _require_opened_here(request, secret)
    shown = page(request, "lti_pick.html", status=status, desk=desk, secret=secret, problem=problem)
    return framed_by(shown, desk.platform.issuer, desk.platform.login_url, desk.asked.back)


def _require_opened_here(request: Request, secret: str) -> None:
    if not hmac.compare_digest(request.cookies.get(OPENED, "").encode(), secret.encode()):
        raise RefusedError("picking_over")


def _origin(address: str) -> str:
    parts = urlsplit(address)
    return f"{parts.scheme}://{parts.netloc}"
