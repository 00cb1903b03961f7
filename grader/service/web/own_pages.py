"""The course's own assignments: uploaded, examined, downloaded, removed."""

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, File, Form, Path, Query, Response, UploadFile
from fastapi.responses import RedirectResponse

from grader.catalog import default_root
from grader.contracts.errors import RefusedError
from grader.contracts.own_assignment import OwnState
from grader.service.requests.answers import to_save
from grader.service.web.access import InstructorDep, PageErrand, StaffDep, require_staff
from grader.service.web.errors import form_problem
from grader.service.web.forms import MOST_FILE_BYTES, OWN_FORM
from grader.service.web.pages import page
from grader.use_cases import own_assignments, rubric_changes

router = APIRouter(prefix="/class/own", include_in_schema=False, dependencies=[Depends(require_staff)])
Id = Annotated[str, Path(max_length=64)]
Done = Annotated[Literal["", "uploaded", "removed"], Query()]


@router.get("")
def read_all(errand: StaffDep, done: Done = "") -> Response:
    """Show what was uploaded, whether it can be used, and what its scripts scored."""
    return _page(errand, done=done)


@router.post("", dependencies=OWN_FORM)
def upload(errand: InstructorDep, file: Annotated[UploadFile, File()]) -> Response:
    """Take a folder in, or show what is wrong with it."""
    try:
        own_assignments.upload(errand.services, errand.caller, file.file.read(MOST_FILE_BYTES + 1))
    except RefusedError as error:
        return _page(errand, error=error)
    return RedirectResponse("/class/own?done=uploaded", status_code=303)


@router.get("/template.zip")
def download_template(
    errand: InstructorDep,
    id: Annotated[str, Query(max_length=64)] = "my_exercise",
    like: Annotated[str, Query(max_length=64)] = "",
) -> Response:
    """Send a folder to begin with: an example, or a copy of a shipped assignment."""
    content = own_assignments.template(errand.services, errand.caller, id.strip(), like)
    return Response(content, 200, to_save(f"{id.strip()}.zip"), "application/zip")


@router.get("/{assignment_id}/folder.zip")
def download(errand: InstructorDep, assignment_id: Id) -> Response:
    """Send the folder that was uploaded last."""
    content = own_assignments.folder(errand.services, errand.caller, assignment_id)
    return Response(content, 200, to_save(f"{assignment_id}.zip"), "application/zip")


@router.post("/{assignment_id}/adopt", dependencies=OWN_FORM)
def adopt_scores(errand: InstructorDep, assignment_id: Id) -> Response:
    """Have a refused folder examined again, with the scores of its wrong scripts as those wanted."""
    try:
        rubric_changes.adopt_scores(errand.services, errand.caller, assignment_id)
    except RefusedError as error:
        return _page(errand, error=error, of=assignment_id)
    return RedirectResponse("/class/own?done=uploaded", status_code=303)


@router.post("/{assignment_id}/remove", dependencies=OWN_FORM)
def remove(
    errand: InstructorDep, assignment_id: Id, reason: Annotated[str, Form(max_length=1_000)] = ""
) -> Response:
    """Remove an assignment for which nothing was handed in."""
    try:
        own_assignments.remove(errand.services, errand.caller, assignment_id, reason.strip())
    except RefusedError as error:
        return _page(errand, error=error, of=assignment_id)
    return RedirectResponse("/class/own?done=removed", status_code=303)


def _page(errand: PageErrand, *, error: RefusedError | None = None, of: str = "", done: str = "") -> Response:
    found = own_assignments.own_assignments(errand.services, errand.caller)
    problem = None if error is None else form_problem(error, errand.language)
    return page(
        errand.request,
        "own.html",
        status=200 if problem is None else problem.status,
        uploads=found,
        titles={id_: assignment.title for id_, assignment in errand.assignments.items()},
        shipped=[
            assignment
            for assignment in errand.services.assignments.of(None).all()
            if (default_root() / assignment.id).is_dir()
        ],
        waits=any(own.state is OwnState.WAITING for own in found),
        problem=problem,
        problem_of=of,
        misfits=() if error is None else error.members.get("misfits", ()),
        done=done,
    )
