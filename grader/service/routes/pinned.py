"""What is said to every student with a certain mistake."""

from typing import Annotated

from fastapi import APIRouter, Path
from pydantic import Field

from grader.service.requests.dependencies import AssignmentId, InstructorDep, StaffDep
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases.bodies import Body
from grader.use_cases.pinning import LONGEST_PINNED, pin, pinned

router = APIRouter(prefix="/api/v1/assignments/{assignment_id}/pinned", tags=["dashboard"])
_ON_READ = ("assignment_not_found", "invalid_request", "forbidden")


class PinnedBody(Body):
    """What to say."""

    text: str = Field(max_length=LONGEST_PINNED, description="Empty: nothing any more.")


class PinnedList(View):
    """All that is pinned at an assignment."""

    pinned: dict[str, str] = Field(description="By the code of the mistake.")


@router.get("", summary="What is pinned to mistakes", responses=responses(*_ON_READ))
def read(errand: StaffDep, assignment_id: AssignmentId) -> PinnedList:
    """Return what students with certain mistakes read above the hint."""
    return PinnedList(pinned=pinned(errand.services, errand.caller, assignment_id))


@router.put(
    "/{mistake}",
    summary="Pin a sentence to a mistake",
    responses=responses(*_ON_READ, "malformed_body", "too_large", "no_course", "course_archived"),
)
def change(
    errand: InstructorDep,
    assignment_id: AssignmentId,
    mistake: Annotated[str, Path(max_length=64, examples=["turn_degrees_as_radians"])],
    body: PinnedBody,
) -> PinnedList:
    """Put a sentence in place of what was pinned there."""
    pin(errand.services, errand.caller, assignment_id, mistake, body.text)
    return read(errand, assignment_id)
