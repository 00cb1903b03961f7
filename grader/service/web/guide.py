"""The guide for students (``docs/student.md``) as a page, and the pre-check that it tells them to install."""

import re
from functools import cache
from pathlib import Path
from typing import Final

from fastapi import APIRouter, Request, Response
from markupsafe import Markup, escape

from grader.contracts.errors import RefusedError
from grader.contracts.text import Language
from grader.formats.installation import wheel, wheel_name
from grader.service.web.access import language_of
from grader.service.web.pages import page

router = APIRouter(include_in_schema=False)
ADDRESS: Final = "/guide"
_FILES: Final[dict[Language, str]] = {"zh": "student.zh.md", "en": "student.md"}
_WHEEL: Final = "ADDRESS/download/grader.whl"
"""What the guide has where its page names this service and its version."""

_TITLE: Final = re.compile(r"\A# (.+)\n+\[[^\]]+\]\([\w.]+\)\n")
"""The heading, and the link to the other language, which the page's own switch replaces."""

_BETWEEN_CHINESE: Final = re.compile(r"(?<=[\u3000-\u9fff\uff00-\uffef])\n(?=[\u3000-\u9fff\uff00-\uffef])")
"""A line end that a browser would show as a blank, where Chinese has none."""


@router.get(ADDRESS)
def read(request: Request) -> Response:
    """Show the guide."""
    title, content = guide(language_of(request))
    address = escape(f"{request.base_url}download/{wheel_name()}")
    return page(request, "guide.html", title=title, content=content.replace(_WHEEL, address))


@router.get("/download/{name}")
def download(name: str) -> Response:
    """Return this service's own version as a wheel, which grades on a student's machine as the service does."""
    content = wheel() if name == wheel_name() else None
    if content is None:
        raise RefusedError("not_found")
    return Response(content, media_type="application/octet-stream")


@cache
def guide(language: Language) -> tuple[str, Markup]:
    """Return title and content of the guide, as HTML."""
    from markdown_it import MarkdownIt

    text = _folder().joinpath(_FILES[language]).read_text(encoding="utf-8")
    heading = _TITLE.match(text)
    assert heading is not None, "a test reads both files"
    # Markup in the file is shown, not passed on.
    html = MarkdownIt("js-default").render(text[heading.end() :])
    html = _BETWEEN_CHINESE.sub("", html)
    return heading[1], Markup(html)  # noqa: S704 - of our own file


def _folder() -> Path:
    package = Path(__file__).resolve().parents[2]
    installed = package / "docs"  # as the wheel has it
    return installed if installed.is_dir() else package.parent / "docs"
