"""Forms that only our own pages can send.

A page's forms carry a random token that also stands in a cookie of the same browser (``SameSite=Strict``, not
readable by scripts). Another site can neither read the one nor make the browser send the other. Browsers that
say where a request comes from (``Sec-Fetch-Site``) are believed, too.
"""

import hmac
import re
import secrets
from typing import Annotated

from fastapi import Depends, Form, Request, Response

from grader.contracts.errors import RefusedError

FIELD = "form_token"
COOKIE = "grader_form"
MOST_FILE_BYTES = 1024 * 1024
"""Of a file in a form that is no submission: a request has no more."""
_TOKEN_BYTES = 24
_TOKEN = re.compile(r"[A-Za-z0-9_-]{32}")
_OWN_SITES = ("same-origin", "none")


def token_of(request: Request) -> str:
    """Return the token of the visitor's browser, a fresh one when it has none."""
    known = request.cookies.get(COOKIE, "")
    return known if _TOKEN.fullmatch(known) else secrets.token_urlsafe(_TOKEN_BYTES)


def remember(request: Request, response: Response, token: str) -> None:
    """Give the browser its token unless it has it."""
    if request.cookies.get(COOKIE) != token:
        set_private_cookie(request, response, COOKIE, token)


def set_private_cookie(request: Request, response: Response, name: str, value: str) -> None:
    """Set a cookie that lasts as long as the browser, is sent by our own pages only, and no script can read."""
    secure = request.url.scheme == "https"
    response.set_cookie(name, value, httponly=True, samesite="strict", secure=secure)


def require_own_form(
    request: Request, form_token: Annotated[str, Form(alias=FIELD, max_length=64)] = ""
) -> None:
    """Refuse a form of another site.

    Raises RefusedError: the form was not sent by one of our pages, or the browser was closed in between.
    """
    known = request.cookies.get(COOKIE, "")
    own_site = request.headers.get("sec-fetch-site", "none") in _OWN_SITES
    if not (
        own_site and _TOKEN.fullmatch(known) and hmac.compare_digest(known.encode(), form_token.encode())
    ):
        raise RefusedError("foreign_form")


OWN_FORM = [Depends(require_own_form)]
"""Dependencies of everything that a form changes."""
