"""Who is in the course, and what was changed by whom."""

import re
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, Response

from grader.render.audit_lines import Teller
from grader.use_cases.people import changes, members
from grader.web.access import InstructorDep, QueryWhole, ServicesDep, StaffDep, require_staff
from grader.web.pages import language_of, page

router = APIRouter(prefix="/class", include_in_schema=False, dependencies=[Depends(require_staff)])
_ENTRIES = 50
_LARGEST_ID = 2**63 - 1
_ID = re.compile(r"[A-Za-z0-9_-]{1,64}")


@router.get("/people")
def read_people(
    request: Request,
    services: ServicesDep,
    visitor: StaffDep,
    search: Annotated[str, Query(max_length=100)] = "",
) -> Response:
    """Show the roster."""
    id_ = visitor.caller.course
    course = None if id_ is None else services.courses.get(id_)
    everybody = members(services, visitor.caller)
    wanted = search.strip().lower()
    found = [one for one in everybody if wanted in one.id.lower() or wanted in one.name.lower()]
    return page(request, "people.html", course=course, members=found, all=len(everybody), search=search)


@router.get("/audit")
def read_audit(
    request: Request,
    services: ServicesDep,
    visitor: InstructorDep,
    before: Annotated[QueryWhole | None, Query(ge=0, le=_LARGEST_ID)] = None,
) -> Response:
    """Show changes of grades and settings, newest first."""
    entries, more = changes(services, visitor.caller, before, _ENTRIES)
    teller = Teller(language_of(request), services.rules.of(visitor.caller.course).zone)
    lines = [(one, teller.differences(one.before, one.after), address(one.subject)) for one in entries]
    return page(request, "audit.html", lines=lines, teller=teller, next_before=more, newest=before is None)


def address(subject: str) -> str:
    """Return the page of what an entry of the log is about, empty where there is none."""
    kind, _, name = subject.partition(",")[0].partition(" ")  # what follows a comma is a part of it
    if kind == "submission" and _ID.fullmatch(name):
        return f"/submissions/{name}"
    if kind == "assignment" and _ID.fullmatch(name):
        return f"/class/rules/{name}"
    return f"/class/regrades/{name.split()[0]}" if kind == "regrade" and name else ""
