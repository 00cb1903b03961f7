"""Static files, compressed once, under an address that changes with their content.

``/static/<version>/<name>`` holds for ever: a browser, or a proxy for all of a campus, asks for each once. Scripts
import each other by their names, so they all stand under one version, a digest of all of them. A page of before an
upgrade may still ask under another version, or anybody under none: they get today's file, and ask again each time.
"""

import gzip
import hashlib
import mimetypes
from dataclasses import dataclass
from functools import cache
from http import HTTPStatus
from pathlib import Path

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from grader.service.requests.answers import accepts_gzip

FOLDER = Path(__file__).parent / "static"
_FOR_EVER = "public, max-age=31536000, immutable"


@dataclass(frozen=True, slots=True)
class StaticFile:
    """One file, plain and compressed."""

    media_type: str
    content: bytes
    compressed: bytes
    tag: str


@cache
def files() -> dict[str, StaticFile]:
    """Return the files by their names."""
    return {path.name: _read(path) for path in sorted(FOLDER.iterdir())}


@cache
def address() -> str:
    """Return where pages find the files of this version."""
    whole = "".join(f"{name} {one.tag} " for name, one in files().items())
    return f"/static/{hashlib.sha256(whole.encode()).hexdigest()[:12]}"


class StaticFiles:
    """Answers for the files, as an ASGI application mounted at ``/static``."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["method"] != "GET":
            raise HTTPException(HTTPStatus.METHOD_NOT_ALLOWED, headers={"Allow": "GET, HEAD"})
        below = scope["path"].removeprefix(scope["root_path"]).removeprefix("/")
        version, _, name = below.rpartition("/")
        file = files().get(name)
        if file is None or "/" in version:
            raise HTTPException(HTTPStatus.NOT_FOUND)
        headers = {"ETag": file.tag, "Vary": "Accept-Encoding"}
        if f"/static/{version}" == address():
            headers["Cache-Control"] = _FOR_EVER
        content = file.content
        if accepts_gzip(Headers(scope=scope).get("accept-encoding")):
            headers["Content-Encoding"], content = "gzip", file.compressed
        await Response(content, media_type=file.media_type, headers=headers)(scope, receive, send)


def _read(path: Path) -> StaticFile:
    content = path.read_bytes()
    return StaticFile(
        media_type=mimetypes.guess_type(path.name)[0] or "application/octet-stream",
        content=content,
        compressed=gzip.compress(content, mtime=0),
        tag=f'W/"{hashlib.sha256(content).hexdigest()[:16]}"',
    )
