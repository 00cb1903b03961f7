"""Who is in the course, and what was changed by whom."""

import re
from collections.abc import Sequence
from typing import Annotated, Literal
from urllib.parse import quote

from fastapi import APIRouter, Depends, File, Form, Path, Query, Request, Response, UploadFile
from fastapi.responses import RedirectResponse
from markupsafe import Markup
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Member, Role, RosterEntry, Seen, sections_of
from grader.formats.sheets.roster import as_csv
from grader.formats.sheets.writing import csv_table
from grader.render.audit_lines import Teller
from grader.service.requests.answers import to_save
from grader.service.web.access import ENTER, InstructorDep, PageErrand, QueryWhole, StaffDep, require_staff
from grader.service.web.errors import FormProblem, form_problem
from grader.service.web.forms import MOST_FILE_BYTES, OWN_FORM
from grader.service.web.pages import page, qr_code
from grader.use_cases import people, signing_in
from grader.use_cases.people import ImportPlan, changes, members

router = APIRouter(prefix="/class", include_in_schema=False, dependencies=[Depends(require_staff)])
_ENTRIES = 50
_LARGEST_ID = 2**63 - 1
_ID = re.compile(r"[A-Za-z0-9_-]{1,64}")
_SECTION_SEPARATOR = re.compile("[,;，；、]")
_DAYS = 200
PersonId = Annotated[str, Path(max_length=64)]
Done = Annotated[Literal["", "saved", "removed", "imported", "none_missing"], Query()]


class PeopleQuery(BaseModel):
    """Whose ids or names contain `search`, of a section; and what was done: `added` and `changed` by an import."""

    search: str = Field(default="", max_length=100)
    section: str = Field(default="", max_length=64)
    done: Literal["", "saved", "removed", "imported", "none_missing"] = ""
    added: QueryWhole = 0
    changed: QueryWhole = 0


class MemberForm(BaseModel):
    """What somebody shall be in the course; fields that are empty are empty then."""

    person: str = Field(default="", max_length=200)
    name: str = Field(default="", max_length=200)
    role: Role = Role.STUDENT
    email: str = Field(default="", max_length=254)
    sections: str = Field(default="", max_length=1_000)

    @classmethod
    def of(cls, member: Member) -> "MemberForm":
        """Return the form that leaves `member` as it is."""
        return cls(
            person=member.id,
            name=member.name,
            role=member.role,
            email=member.email,
            sections=", ".join(member.sections),
        )

    def entry(self) -> RosterEntry:
        """Return what the form says."""
        sections = tuple(one.strip() for one in _SECTION_SEPARATOR.split(self.sections) if one.strip())
        return RosterEntry(
            id=self.person.strip(), name=self.name, role=self.role, email=self.email, sections=sections
        )


@router.get("/people")
def read_people(errand: StaffDep, query: Annotated[PeopleQuery, Query()]) -> Response:
    """Show the roster."""
    return _people_page(errand, query)


@router.post("/people", dependencies=OWN_FORM)
def add_member(errand: InstructorDep, form: Annotated[MemberForm, Form()]) -> Response:
    """Add somebody, or show the form again with what is wrong."""
    try:
        people.add_member(errand.services, errand.caller, form.entry())
    except RefusedError as error:
        problem = form_problem(error, errand.language, field="person")
        return _people_page(errand, form=form, problem=problem)
    return RedirectResponse("/class/people?done=saved", status_code=303)


@router.post("/people/preview", dependencies=OWN_FORM)
def preview_import(errand: InstructorDep, file: Annotated[UploadFile, File()]) -> Response:
    """Show what importing a class list would change."""
    try:
        plan = people.plan_import(errand.services, errand.caller, file.file.read(MOST_FILE_BYTES + 1))
    except RefusedError as error:
        problem = form_problem(error, errand.language, field="file")
        return _people_page(errand, problem=problem)
    return _preview_page(errand.request, plan)


@router.post("/people/import", dependencies=OWN_FORM)
def import_list(
    errand: InstructorDep,
    entries: Annotated[str, Form(max_length=MOST_FILE_BYTES)],
    seen: Annotated[str, Form(max_length=64)],
    remove: Annotated[bool, Form()] = False,
) -> Response:
    """Import the class list whose preview was confirmed."""
    content, caller = entries.encode(), errand.caller
    try:
        plan = people.import_list(
            errand.services, caller, content, skip=True, remove=remove, seen=Seen.one(seen)
        )
    except RefusedError as error:
        if error.code == "changed_meanwhile":
            return _preview_page(
                errand.request, people.plan_import(errand.services, caller, content), meanwhile=True
            )
        problem = form_problem(error, errand.language, field="file")
        return _people_page(errand, problem=problem)
    counts = f"added={len(plan.change.added)}&changed={len(plan.change.changed)}"
    return RedirectResponse(f"/class/people?done=imported&{counts}", status_code=303)


@router.post("/people/tokens", dependencies=OWN_FORM)
def make_tokens(
    errand: InstructorDep,
    form: Annotated[str, Form(pattern="^(csv|sheet)$")] = "sheet",
    section: Annotated[str, Form(max_length=64)] = "",
    everybody: Annotated[bool, Form()] = False,
) -> Response:
    """Make tokens for a section or all, as a table or as slips to print."""
    services, caller = errand.services, errand.caller
    made = people.give_tokens(services, caller, _DAYS, section=section, everybody=everybody)
    if not made:
        return RedirectResponse("/class/people?done=none_missing", status_code=303)
    if form == "csv":
        head = (*people.TOKEN_COLUMNS, "link")
        rows = [(*people.token_cells(one, token), _link(errand.request, token)) for one, token in made]
        table = csv_table([head, *rows])
        return Response(table, 200, to_save("tokens.csv"), "text/csv; charset=utf-8")
    return _slips_page(errand, made)


@router.get("/people/{person}")
def read_member(errand: StaffDep, person: PersonId, done: Done = "") -> Response:
    """Show one member, to be changed."""
    return _member_page(errand, people.member_of(errand.services, errand.caller, person), done=done)


@router.post("/people/{person}", dependencies=OWN_FORM)
def change_member(errand: InstructorDep, person: PersonId, form: Annotated[MemberForm, Form()]) -> Response:
    """Change a member, or show the form again with what is wrong."""
    member = people.member_of(errand.services, errand.caller, person)
    form = form.model_copy(update={"person": person})
    try:
        people.set_member(errand.services, errand.caller, form.entry())
    except RefusedError as error:
        return _member_page(errand, member, form=form, error=error)
    return RedirectResponse(f"/class/people/{quote(person, safe='')}?done=saved", status_code=303)


@router.post("/people/{person}/renumber", dependencies=OWN_FORM)
def renumber(
    errand: InstructorDep,
    person: PersonId,
    new: Annotated[str, Form(max_length=200)] = "",
    reason: Annotated[str, Form(max_length=1_000)] = "",
) -> Response:
    """Give a student another id."""
    member = people.member_of(errand.services, errand.caller, person)
    try:
        people.renumber(errand.services, errand.caller, person, new, reason.strip())
    except RefusedError as error:
        return _member_page(errand, member, error=error)
    return RedirectResponse(f"/class/people/{quote(new.strip(), safe='')}?done=saved", status_code=303)


@router.post("/people/{person}/remove", dependencies=OWN_FORM)
def remove_member(
    errand: InstructorDep, person: PersonId, reason: Annotated[str, Form(max_length=1_000)] = ""
) -> Response:
    """Take a member out of the course."""
    member = people.member_of(errand.services, errand.caller, person)
    try:
        people.remove_member(errand.services, errand.caller, person, reason.strip())
    except RefusedError as error:
        return _member_page(errand, member, error=error)
    return RedirectResponse("/class/people?done=removed", status_code=303)


@router.post("/people/{person}/token", dependencies=OWN_FORM)
def make_token(errand: StaffDep, person: PersonId) -> Response:
    """Make a token for a member and show it, this once."""
    member = people.member_of(errand.services, errand.caller, person)
    token = people.give_token(errand.services, errand.caller, person, _DAYS)
    return _slips_page(errand, [(member, token)])


@router.post("/people/{person}/unbind", dependencies=OWN_FORM)
def unbind(
    errand: InstructorDep, person: PersonId, identity: Annotated[str, Form(max_length=16)] = ""
) -> Response:
    """Unbind a member from an identity at a provider."""
    member = people.member_of(errand.services, errand.caller, person)
    signing_in.unbind(errand.services, errand.caller, member.id, identity)
    return RedirectResponse(f"/class/people/{quote(person, safe='')}?done=saved", status_code=303)


@router.get("/audit")
def read_audit(
    errand: InstructorDep, before: Annotated[QueryWhole | None, Query(ge=0, le=_LARGEST_ID)] = None
) -> Response:
    """Show changes of grades and settings, newest first."""
    entries, more = changes(errand.services, errand.caller, before, _ENTRIES)
    teller = Teller(errand.language, errand.services.rules.of(errand.caller.course).zone)
    lines = [(one, teller.differences(one.before, one.after), address(one.subject)) for one in entries]
    return page(
        errand.request, "audit.html", lines=lines, teller=teller, next_before=more, newest=before is None
    )


def _people_page(
    errand: PageErrand,
    query: PeopleQuery | None = None,
    *,
    form: MemberForm | None = None,
    problem: FormProblem | None = None,
) -> Response:
    course, _ = people.myself(errand.services, errand.caller)
    is_instructor = course is not None and errand.caller.is_instructor
    everybody = members(errand.services, errand.caller)
    query = query or PeopleQuery()
    wanted = query.search.strip().lower()
    found = [
        one
        for one in everybody
        if (wanted in one.id.lower() or wanted in one.name.lower())
        and (not query.section or query.section in one.sections)
    ]
    return page(
        errand.request,
        "people.html",
        status=200 if problem is None else problem.status,
        course=course,
        members=found,
        all=len(everybody),
        sections=sections_of(everybody),
        query=query,
        form=form or MemberForm(),
        problem=problem,
        roles=list(Role),
        without_token=len(people.without_token(errand.services, errand.caller)) if is_instructor else 0,
    )


def _member_page(
    errand: PageErrand,
    member: Member,
    *,
    form: MemberForm | None = None,
    error: RefusedError | None = None,
    done: str = "",
) -> Response:
    problem = None if error is None else form_problem(error, errand.language)
    services, caller = errand.services, errand.caller
    ways = signing_in.ways_of(services, caller, member.id) if caller.is_instructor else ()
    return page(
        errand.request,
        "person.html",
        ways=ways,
        status=200 if problem is None else problem.status,
        member=member,
        form=form or MemberForm.of(member),
        problem=problem,
        roles=list(Role),
        done=done,
    )


def _slips_page(errand: PageErrand, made: Sequence[tuple[Member, str]]) -> Response:
    """Show new tokens on slips to print, those of a section together."""
    course, _ = people.myself(errand.services, errand.caller)
    sections: dict[str, list[tuple[Member, str, Markup]]] = {}
    for one, token in sorted(made, key=lambda slip: (slip[0].sections, slip[0].id)):
        code = qr_code(_link(errand.request, token))
        sections.setdefault(", ".join(one.sections), []).append((one, token, code))
    address = str(errand.request.base_url)
    return page(errand.request, "token_slips.html", sections=sections, course=course, address=address)


def _link(request: Request, token: str) -> str:
    """Return an address that fills in a token; what stands behind # no server and no proxy ever sees."""
    return f"{str(request.base_url).rstrip('/')}{ENTER}#{token}"


def _preview_page(request: Request, plan: ImportPlan, *, meanwhile: bool = False) -> Response:
    entries = as_csv(plan.roster.entries)
    return page(request, "people_import.html", plan=plan, entries=entries, meanwhile=meanwhile)


def address(subject: str) -> str:
    """Return the page of what an entry of the log is about, empty where there is none."""
    kind, _, name = subject.partition(",")[0].partition(" ")  # what follows a comma is a part of it
    if kind == "submission" and _ID.fullmatch(name):
        return f"/submissions/{name}"
    if kind == "assignment" and _ID.fullmatch(name):
        return f"/class/rules/{name}"
    return f"/class/regrades/{name.split()[0]}" if kind == "regrade" and name else ""
