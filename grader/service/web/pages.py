"""Rendering: templates, the language of a page, and the headers and cookies every page carries.

No template can show raw text: the environment passes every string that is not already markup through
`grader.render.escape.visible_html`, so that control characters, bidi marks and tags are only ever seen.
"""

from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from fastapi import Request, Response
from fastapi.responses import HTMLResponse
from fastapi.templating import Jinja2Templates
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from starlette.routing import Match

from grader.contracts.text import Language
from grader.messages import on_page, quantity
from grader.render.escape import visible_html
from grader.render.labels import status_word
from grader.service.web import forms
from grader.service.web.access import LANGUAGE_COOKIE, language_of, visitor_of
from grader.service.web.compiled import CompiledTemplates
from grader.service.web.line_links import linked
from grader.service.web.static_files import address

FOLDER = Path(__file__).parent
_A_YEAR_S = 365 * 24 * 3600
_HTML_LANGUAGE = {"zh": "zh-CN", "en": "en"}
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    "Cache-Control": "no-store",
}


def page(request: Request, template: str, *, status: int = 200, **values: Any) -> HTMLResponse:
    """Return a page in the visitor's language; `values` are what its template shows."""
    language = language_of(request)
    token = forms.token_of(request)
    context = {**_context(request, language, token), **values}
    headers = {**_HEADERS, "Content-Language": _HTML_LANGUAGE[language]}
    response = _TEMPLATES.TemplateResponse(request, template, context, status_code=status, headers=headers)
    keep_language(request, response)
    forms.remember(request, response, token)
    return response


def keep_language(request: Request, response: Response) -> None:
    """Let a browser remember the language that ``?lang=`` chose, also where the answer leads elsewhere."""
    language = language_of(request)
    if request.cookies.get(LANGUAGE_COOKIE) != language and "lang" in request.query_params:
        response.set_cookie(LANGUAGE_COOKIE, language, max_age=_A_YEAR_S, httponly=True, samesite="lax")


def fragment(request: Request, template: str, **values: Any) -> str:
    """Return a part of a page, which a script of ours puts into it."""
    context = {**_context(request, language_of(request), ""), **values}
    return _TEMPLATES.env.get_template(template).render(context)


def _context(request: Request, language: Language, token: str) -> dict[str, Any]:
    visitor = visitor_of(request)
    return {
        "lang": language,
        "html_lang": _HTML_LANGUAGE[language],
        "say": partial(on_page, language),
        "visitor": visitor,
        "course_zone": visitor.zone,
        "form_token": token,
        "other_language": _other_language(request, language),
        "here": request.url.path,
    }


def _is_read(request: Request) -> bool:
    """Whether a form's address answers to GET as well."""
    scope = {**request.scope, "method": "GET"}
    return any(route.matches(scope)[0] is Match.FULL for route in request.app.routes)


def qr_code(text: str) -> Markup:
    """Return a QR code as a drawing to be put into a page."""
    import segno

    drawing = segno.make(text, micro=False).svg_inline(omitsize=True, svgclass="qr", lineclass=None)
    return Markup(drawing)  # noqa: S704  what segno writes: paths, no text


def compile_all() -> None:
    """Compile every template, so that nobody's first page waits for that."""
    for name in _TEMPLATES.env.list_templates(extensions=["html"]):
        _TEMPLATES.env.get_template(name)


def _other_language(request: Request, language: Language) -> dict[str, str] | None:
    """Return code, name and address of this page in the other language.

    What a form is answered with has none, unless its address shows a page by itself, as where a form was refused.
    """
    if request.method == "POST" and not _is_read(request):
        return None
    other: Language = "en" if language == "zh" else "zh"
    url = request.url.include_query_params(lang=other)
    return {
        "code": _HTML_LANGUAGE[other],
        "name": on_page(other, "language.name"),
        "href": f"/{url.path.lstrip('/')}?{url.query}",  # two slashes would begin another host's address
    }


def _shown(value: object) -> object:
    """Make any plain string harmless before it is put into a page."""
    if isinstance(value, str) and not hasattr(value, "__html__"):
        return Markup(visible_html(value))  # noqa: S704  escaped in the same breath
    return value


def _local(instant: datetime, zone: str, form: str = "%Y-%m-%d %H:%M") -> str:
    """Return an instant on the clock of a time zone: what is due says so everywhere alike."""
    return instant.astimezone(ZoneInfo(zone)).strftime(form)


def _megabytes(number: int) -> str:
    return f"{number / 1e6:.1f} MB"


def _environment() -> Environment:
    environment = Environment(
        loader=CompiledTemplates(FOLDER / "templates", Path(__file__)),
        autoescape=True,
        finalize=_shown,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["points"] = quantity.points
    environment.filters["number"] = quantity.exact
    environment.filters["local"] = _local
    environment.filters["linked"] = linked
    environment.globals.update(status_word=status_word, megabytes=_megabytes, static=address())
    return environment


_TEMPLATES = Jinja2Templates(env=_environment())
