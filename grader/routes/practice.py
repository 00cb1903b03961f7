"""Running a script for practice: the answer tells what was seen, and nothing of it is kept."""

import json
from typing import Any

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from grader.contracts.report import GradeStatus
from grader.routes.dependencies import ENTRY_PROBLEMS, CallerDep, LanguageDep, ServicesDep
from grader.routes.middleware import UploadRoute
from grader.routes.problems import responses
from grader.routes.submissions import (
    AssignmentField,
    RunView,
    SeenItemView,
    UploadedFile,
    item_view,
    run_view,
)
from grader.use_cases.handing_in import most_upload_bytes
from grader.use_cases.practising import practise

router = APIRouter(prefix="/api/v1/practice", tags=["practice"], route_class=UploadRoute)


class PracticeView(BaseModel):
    """What a practice run showed. There are no points: only handing in earns them."""

    assignment: str = Field(examples=["square"])
    assignment_version: int = Field(examples=[1])
    status: GradeStatus = Field(description="How the run ended.", examples=["graded"])
    hint: str = Field(description="The one next step that matters most.")
    mistakes: list[str] = Field(description="Codes of recognised mistakes, likeliest first.")
    items: list[SeenItemView] = Field(description="Items that the caller sees.")
    runs: list[RunView] = Field(description="The run of the assignment's first case.")
    trajectory: dict[str, Any] | None = Field(
        description="What the car did, as `/api/v1/submissions/{id}/trajectory` tells it; null: nothing."
    )


@router.post(
    "",
    summary="Run a script for practice",
    responses=responses(
        *ENTRY_PROBLEMS,
        "no_course",
        "assignment_not_found",
        "practice_scripts_only",
        "practice_off",
        "practice_full",
        "practice_waits",
        "malformed_body",
        "too_large",
        "unsupported_media_type",
        "wrong_file_type",
        "invalid_request",
        "empty",
        "not_utf8",
        "contains_nul",
    ),
)
async def run(  # noqa: PLR0913, PLR0917
    services: ServicesDep,
    caller: CallerDep,
    language: LanguageDep,
    response: Response,
    file: UploadedFile,
    assignment: AssignmentField,
) -> PracticeView:
    """Run a script in the sandbox in virtual time and tell what was seen. It costs no attempt; nothing is kept."""
    content = await file.read(most_upload_bytes(services) + 1)
    seen = await practise(services, caller, assignment, file.filename or "", content)
    report = json.loads(seen.report.canonical_bytes())
    response.headers.update(
        {"Content-Language": language, "Vary": "Accept-Language", "Cache-Control": "no-store"}
    )
    items = [item_view(item, language).model_dump() for item in report["items"]]
    return PracticeView(
        assignment=seen.report.assignment,
        assignment_version=seen.report.assignment_version,
        status=seen.report.status,
        hint=seen.report.hint.get(language),
        mistakes=list(seen.report.mistakes),
        items=[SeenItemView.model_validate(item) for item in items],
        runs=[run_view(one) for one in report["runs"]],
        trajectory=None if seen.trajectory is None else json.loads(seen.trajectory),
    )
