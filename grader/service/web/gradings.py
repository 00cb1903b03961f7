"""Every grading of a submission, two of them side by side, and the report in other graders' formats."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Response
from fastapi.responses import JSONResponse

from grader.contracts.judgement import judged
from grader.service.requests.answers import to_save
from grader.service.web import access
from grader.service.web.access import QueryWhole, StaffDep, SubmissionId, require_staff
from grader.service.web.comparison import compare
from grader.service.web.pages import page
from grader.use_cases.gradebook import Platform, exported
from grader.use_cases.people import names, person
from grader.use_cases.regrading import history, past_grading

router = APIRouter(
    prefix="/class/submissions/{submission_id}",
    include_in_schema=False,
    dependencies=[Depends(require_staff)],
)
_Attempt = Annotated[QueryWhole, Query(ge=0, le=1_000_000)]


@router.get("/gradings")
def read_all(errand: StaffDep, submission_id: SubmissionId) -> Response:
    """Show when, with which versions and why a submission was graded."""
    submission, _ = access.seen(errand, submission_id)
    return page(
        errand.request,
        "gradings.html",
        submission=submission,
        person=person(names(errand.services, errand.caller), submission.student),
        gradings=history(errand.services, errand.caller, submission.id),
        titles={id_: assignment.title for id_, assignment in errand.assignments.items()},
    )


@router.get("/gradings/compare")
def read_comparison(
    errand: StaffDep, submission_id: SubmissionId, first: _Attempt, second: _Attempt
) -> Response:
    """Show two gradings of one submission side by side, the earlier first."""
    submission, _ = access.seen(errand, submission_id)
    earlier, later = (
        past_grading(errand.services, errand.caller, submission.id, attempt)
        for attempt in sorted((first, second))
    )
    return page(
        errand.request,
        "compare_gradings.html",
        submission=submission,
        person=person(names(errand.services, errand.caller), submission.student),
        comparison=compare(judged(earlier), judged(later), "", "", errand.language),
        gradings=(earlier, later),
        regrade=None,
    )


@router.get("/{platform}.json")
def read_export(errand: StaffDep, submission_id: SubmissionId, platform: Platform) -> Response:
    """Return the report as an autograder of Gradescope or PrairieLearn writes it, to be saved."""
    submission, _ = access.seen(errand, submission_id)
    document = exported(errand.services, errand.caller, submission.id, platform, errand.language)
    return JSONResponse(document, headers=to_save(f"{platform}-{submission.id}.json"))
