"""Answers that are sent compressed to clients that accept gzip."""

from fastapi import Response
from fastapi.responses import StreamingResponse

from grader.use_cases.recordings import Recording


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
