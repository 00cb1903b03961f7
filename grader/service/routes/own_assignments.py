"""Assignments of the course's own: uploaded as a zip, examined, downloaded, removed."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Depends, File, Path, Query, Response, UploadFile, status
from pydantic import Field

from grader.contracts.own_assignment import OwnAssignment, OwnState
from grader.contracts.text import EMPTY, Language
from grader.service.requests.answers import PRIVATE, to_save
from grader.service.requests.dependencies import InstructorDep, LanguageDep, StaffDep
from grader.service.requests.middleware import MOST_BYTES, known_parts
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases import own_assignments

router = APIRouter(prefix="/api/v1/course/assignments", tags=["course"])
_ON_READ = ("forbidden", "invalid_request")
_ON_CHANGE = (*_ON_READ, "no_course", "course_archived")
Id = Annotated[str, Path(max_length=64, examples=["heptagon"])]


class MisfitView(View):
    """Something wrong in one of the files."""

    file: str = Field(examples=["assignment.yaml"])
    line: int | None = Field(description="From 1; null where no line is meant.", examples=[12])
    field: str = Field(description="May be empty.", examples=["items.2.low"])
    detail: str = Field(description="What is wrong, and what to do.")


class VerdictView(View):
    """What one of the assignment's own scripts scored."""

    script: str = Field(examples=["wrong/open_corner.py"])
    score: float | None = Field(description="Null while a person has still to grade.", examples=[75.0])
    max_score: float = Field(examples=[100.0])
    problem: str = Field(description="Why this is not what it must get; empty when it is.", examples=[""])


class OwnAssignmentView(View):
    """An upload of an assignment: the one that is used, or a later one that waits or was refused."""

    assignment: str = Field(examples=["heptagon"])
    version: int = Field(examples=[1])
    state: OwnState = Field(
        description="`waiting`: its scripts are still to be run; `ready`: the course uses it; `refused`: a script "
        "did not get what it must."
    )
    uploaded_at: datetime
    uploaded_by: str = Field(examples=["wang"])
    size_bytes: int = Field(description="Of the zip that is stored.", examples=[8192])
    scripts: list[VerdictView] = Field(description="What running the scripts showed.")
    begun: int = Field(description="How many scripts were begun, while they are run; then 0.", examples=[0])
    in_all: int = Field(description="Of how many; 0: they are not run now.", examples=[0])
    misfits: list[MisfitView] = Field(description="Why they could not be run.")
    trouble: str = Field(description="What the service failed at; it tries again. Empty: nothing.")


class OwnAssignmentList(View):
    """What was uploaded to the course, by id and then by age."""

    assignments: list[OwnAssignmentView]


@router.get("", summary="The course's own assignments", responses=responses(*_ON_READ))
def read_all(errand: StaffDep, language: LanguageDep, response: Response) -> OwnAssignmentList:
    """Return what was uploaded, whether it can be used, and what its scripts scored."""
    response.headers.update(PRIVATE)
    uploads = own_assignments.own_assignments(errand.services, errand.caller)
    return OwnAssignmentList(assignments=[_view(one, language) for one in uploads])


@router.post(
    "",
    dependencies=[Depends(known_parts)],
    summary="Upload an assignment",
    status_code=status.HTTP_202_ACCEPTED,
    responses=responses(
        *_ON_CHANGE, "invalid_assignment", "too_many_assignments", "malformed_body", "too_large"
    ),
)
def upload(
    errand: InstructorDep,
    language: LanguageDep,
    response: Response,
    file: Annotated[UploadFile, File(description="The assignment's folder as a zip; at most 1 MiB.")],
) -> OwnAssignmentView:
    """Take a folder in, or a newer version of one. The course can use it once its scripts got what they must.

    An assignment that is new in the course begins as a draft: `PUT …/rules` publishes it.
    """
    response.headers.update(PRIVATE)
    return _view(
        own_assignments.upload(errand.services, errand.caller, file.file.read(MOST_BYTES + 1)), language
    )


@router.get(
    "/{assignment_id}/folder.zip",
    summary="The folder of an uploaded assignment",
    response_class=Response,
    responses={
        200: {"content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}}},
        **responses(*_ON_READ, "assignment_not_found"),
    },
)
def download(errand: InstructorDep, assignment_id: Id) -> Response:
    """Return the folder that was uploaded last, with its solution and wrong scripts."""
    content = own_assignments.folder(errand.services, errand.caller, assignment_id)
    return Response(content, 200, to_save(f"{assignment_id}.zip", **PRIVATE), "application/zip")


@router.delete(
    "/{assignment_id}",
    summary="Remove an uploaded assignment",
    status_code=status.HTTP_204_NO_CONTENT,
    responses=responses(*_ON_CHANGE, "assignment_not_found", "assignment_in_use"),
)
def remove(
    errand: InstructorDep,
    assignment_id: Id,
    reason: Annotated[str, Query(max_length=1_000, description="Goes into the audit log.")] = "",
) -> None:
    """Remove all versions, as long as nothing was handed in for it."""
    own_assignments.remove(errand.services, errand.caller, assignment_id, reason)


def _view(one: OwnAssignment, language: Language) -> OwnAssignmentView:
    examined = one.examined
    return OwnAssignmentView.of(
        one,
        scripts=[
            VerdictView.of(verdict, problem="" if verdict.problem == EMPTY else verdict.problem.get(language))
            for verdict in examined.verdicts
        ],
        begun=examined.begun,
        in_all=examined.scripts,
        misfits=[MisfitView.of(misfit, detail=misfit.told.get(language)) for misfit in examined.misfits],
    )
