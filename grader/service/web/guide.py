"""Guides as pages: for students, with the pre-check that theirs tells them to install, and for teachers."""

import re
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Final, Literal

from fastapi import APIRouter, Depends, Request, Response
from markupsafe import Markup, escape

from grader.contracts.errors import RefusedError
from grader.contracts.text import Language
from grader.formats.installation import wheel, wheel_name
from grader.service.web.access import language_of, require_staff
from grader.service.web.pages import page

router = APIRouter(include_in_schema=False)
for_staff = APIRouter(prefix="/class/guide", include_in_schema=False, dependencies=[Depends(require_staff)])
ADDRESS: Final = "/guide"
Guide = Literal["student", "instructor", "exercises"]
_ADDRESSES: Final[dict[str, str]] = {
    "student": ADDRESS, "instructor": "/class/guide", "exercises": "/class/guide/exercises",
}  # fmt: skip
_FILE_LINK: Final = re.compile(r'<a href="(?!https?:|#)(\w+)(?:\.zh)?\.md(#[^"]*)?">(.*?)</a>')
_NOT_IN_ANCHORS: Final = re.compile(r"[^\w\- ]")
_WHEEL: Final = "ADDRESS/download/grader-VERSION-py3-none-any.whl"
"""What the guide has where its page names this service and its version."""

_TITLE: Final = re.compile(r"\A# (.+)\n+\[[^\]]+\]\([\w.]+\)\n")
"""The heading, and the link to the other language, which the page's own switch replaces."""

_BETWEEN_CHINESE: Final = re.compile(r"(?<=[\u3000-\u9fff\uff00-\uffef])\n(?=[\u3000-\u9fff\uff00-\uffef])")
"""A line end that a browser would show as a blank, where Chinese has none."""


@router.get(ADDRESS)
def read(request: Request) -> Response:
    """Show the guide."""
    title, content = guide("student", language_of(request))
    address = escape(f"{request.base_url}download/{wheel_name()}")
    return page(request, "guide.html", title=title, content=content.replace(_WHEEL, address))


@for_staff.get("")
def read_for_teachers(request: Request) -> Response:
    """Show how a course is run."""
    title, content = guide("instructor", language_of(request))
    return page(request, "guide.html", title=title, content=content)


@for_staff.get("/exercises")
def read_about_exercises(request: Request) -> Response:
    """Show how an exercise is written."""
    title, content = guide("exercises", language_of(request))
    return page(request, "guide.html", title=title, content=content)


@router.get("/download/{name}")
def download(name: str) -> Response:
    """Return this service's own version as a wheel, which grades on a student's machine as the service does."""
    content = wheel() if name == wheel_name() else None
    if content is None:
        raise RefusedError("not_found")
    return Response(content, media_type="application/octet-stream")


@cache
def guide(name: Guide, language: Language) -> tuple[str, Markup]:
    """Return title and content of a guide, as HTML."""
    from markdown_it import MarkdownIt

    file_name = f"{name}.zh.md" if language == "zh" else f"{name}.md"
    text = _folder().joinpath(file_name).read_text(encoding="utf-8")
    heading = _TITLE.match(text)
    assert heading is not None, "a test reads both files"
    # Markup in the file is shown, not passed on.
    markdown = MarkdownIt("js-default")
    tokens = markdown.parse(text[heading.end() :])
    for opening, words in pairwise(tokens):
        if opening.type == "heading_open":
            opening.attrSet("id", _anchor(words.content))
    html = markdown.renderer.render(tokens, markdown.options, {})
    html = _BETWEEN_CHINESE.sub("", _FILE_LINK.sub(_link, html))
    return heading[1], Markup(html)  # noqa: S704 - of our own file


def _anchor(heading: str) -> str:
    """Return what links call a heading, as on GitHub."""
    return _NOT_IN_ANCHORS.sub("", heading.lower()).replace(" ", "-")


def _link(link: re.Match[str]) -> str:
    """Return a link to another guide as one to its page; what has none is only named."""
    name, anchor, words = link.groups()
    return f'<a href="{_ADDRESSES[name]}{anchor or ""}">{words}</a>' if name in _ADDRESSES else words


def _folder() -> Path:
    package = Path(__file__).resolve().parents[2]
    installed = package / "docs"  # as the wheel has it
    return installed if installed.is_dir() else package.parent / "docs"
