"""Answers that pages and programs get alike: what nobody may keep, files to be saved, pictures, trajectories."""

from fastapi import Response
from fastapi.responses import StreamingResponse

from grader.contracts.figure import PictureForm
from grader.contracts.text import Language
from grader.service.requests.dependencies import Errand
from grader.use_cases import recordings
from grader.use_cases.recordings import Recording

_PICTURES: dict[PictureForm, str] = {"png": "image/png", "svg": "image/svg+xml"}

PRIVATE = {"Cache-Control": "no-store", "Vary": "Authorization"}
"""Of what is the caller's alone."""


def to_save(name: str, **headers: str) -> dict[str, str]:
    """Return `headers` and those that let a browser save an answer as `name`; no cache keeps it."""
    return {"Content-Disposition": f'attachment; filename="{name}"', "Cache-Control": "no-store", **headers}


async def plot(
    errand: Errand, submission_id: str, case: str | None, language: Language, form: PictureForm
) -> Response:
    """Return one run as a picture, in any of its forms."""
    drawn = await recordings.picture(errand.services, errand.caller, submission_id, case, language, form)
    headers = {"ETag": f'"{drawn.tag}"', "Content-Language": language, "Vary": "Accept-Language"}
    return Response(drawn.content, media_type=_PICTURES[form], headers=headers)


def accepts_gzip(accept_encoding: str | None) -> bool:
    """Whether a client that sent this ``Accept-Encoding`` (None: it sent none) takes gzip."""
    return "gzip" in (accept_encoding or "").lower()


def trajectory_answer(recording: Recording, accept_encoding: str | None) -> Response:
    """Return the JSON of a recording; if the client accepts gzip, the bytes that are stored."""
    headers = {"ETag": f'"{recording.sha256}"', "Vary": "Accept-Encoding"}
    if not accepts_gzip(accept_encoding):
        return StreamingResponse(recording.parts(), media_type="application/json", headers=headers)
    headers["Content-Encoding"] = "gzip"
    return Response(recording.compressed, media_type="application/json", headers=headers)
