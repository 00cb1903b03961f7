"""The rules of the assignments as pages: everybody of the staff reads them, instructors change them."""

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Form, Query, Response
from fastapi.responses import RedirectResponse

from grader.contracts.assignment import DISTROS, WAYS_TO_RUN, Assignment, Distro, RunsAs
from grader.contracts.errors import RefusedError
from grader.contracts.identity import MOST_SESSION_HOURS, Seen, sections_of
from grader.contracts.rules import LATE_PARAMETERS, NO_EXTENSION, Corrector, Counts, HintRule, Shown
from grader.render.audit_lines import Teller
from grader.service.web.access import AssignmentId, InstructorDep, PageErrand, StaffDep, require_staff
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.service.web.rule_form import (
    CHANGED_MEANWHILE,
    EXTENDED_MEANWHILE,
    ExtensionForm,
    Reader,
    RuleForm,
    extension_form_of,
    form_of,
    late_parameters,
    widgets,
)
from grader.store.rules import CourseRules, tag
from grader.use_cases.assignments import require_published
from grader.use_cases.people import change_course as change_settings
from grader.use_cases.people import members, names
from grader.use_cases.rules import change_rules, course_rules, extensions
from grader.use_cases.rules import extend as extend_for

router = APIRouter(prefix="/class/rules", include_in_schema=False, dependencies=[Depends(require_staff)])
course_router = APIRouter(
    prefix="/class/course", include_in_schema=False, dependencies=[Depends(require_staff)]
)


@router.get("")
def read_all(errand: StaffDep, saved: Annotated[str, Query(pattern="^1?$")] = "") -> Response:
    """Show the rules of every assignment in a line, and a form for several of them."""
    return overview_page(errand, saved=bool(saved))


def overview_page(
    errand: PageErrand, *, form: object = None, errors: dict[str, str] | None = None, saved: bool = False
) -> Response:
    """Return the page of all rules; `form` and `errors` of what was typed for several assignments."""
    known = errand.services.rules.of(errand.caller.course)
    teller = Teller(errand.language, known.zone)
    lines = []
    for assignment in errand.assignments.values():
        rules = known.of(assignment.id)
        late = teller.late(asdict(rules.late), in_full=False)
        lines.append((assignment, rules, late, len(known.extended(assignment.id))))
    return page(
        errand.request,
        "rules.html",
        status=422 if errors else 200,
        lines=lines,
        zone=known.zone,
        course=errand.caller.course,
        distro=known.distro,
        distros=DISTROS,
        runs_as=known.runs_as,
        ways_to_run=WAYS_TO_RUN,
        session_hours=None
        if errand.caller.course is None
        else errand.services.courses.get(errand.caller.course).session_hours,
        most_session_hours=MOST_SESSION_HOURS,
        sections=sections_of(members(errand.services, errand.caller)),
        shown=tuple(Shown),
        correctors=tuple(Corrector),
        form=form,
        errors=errors or {},
        saved=saved,
        may_change=errand.caller.is_instructor and errand.caller.course is not None,
    )


@course_router.post("", dependencies=OWN_FORM)
def change_course(
    errand: InstructorDep,
    distro: Annotated[Distro, Form()],
    runs_as: Annotated[RunsAs | None, Form()] = None,
    session_hours: Annotated[int | None, Form(ge=1, le=MOST_SESSION_HOURS)] = None,
    reason: Annotated[str, Form(max_length=1_000)] = "",
) -> Response:
    """Choose the release of ROS 2 of the course, how its scripts are started, and how long its sessions last."""
    change_settings(
        errand.services,
        errand.caller,
        reason.strip(),
        distro=distro,
        runs_as=runs_as,
        session_hours=session_hours,
    )
    return RedirectResponse("/class/rules?saved=1", status_code=303)


@router.get("/{assignment_id}")
def read(
    errand: StaffDep,
    assignment_id: AssignmentId,
    student: Annotated[str, Query(max_length=64)] = "",
    saved: Annotated[str, Query(pattern="^(|rules|extension)$")] = "",
) -> Response:
    """Show the rules of one assignment and who got more; `student` fills the form of extensions."""
    assignment = require_published(errand.services, errand.caller, assignment_id)
    known = errand.services.rules.of(errand.caller.course)
    extension = _extension_form(known, assignment.id, student)
    return _page(errand, assignment, extension=extension, saved=saved)


@router.post("/{assignment_id}", dependencies=OWN_FORM)
def change(errand: InstructorDep, assignment_id: AssignmentId, form: Annotated[RuleForm, Form()]) -> Response:
    """Put new rules in place of the old ones, or show the form again with what is wrong at its fields."""
    assignment = require_published(errand.services, errand.caller, assignment_id)
    known = course_rules(errand.services, errand.caller, assignment.id)
    reader = Reader(known.zone)
    items = frozenset(item.id for item in assignment.items)
    rules = reader.rules(form, known.of(assignment.id), items)
    if not reader.errors:
        seen = Seen.one(form.seen) if form.seen else None
        try:
            change_rules(errand.services, errand.caller, assignment.id, rules, form.reason.strip(), seen=seen)
        except RefusedError as error:
            if error.code != "changed_meanwhile":
                raise
            reader.errors["form"] = CHANGED_MEANWHILE
            now = errand.services.rules.of(errand.caller.course).of(assignment.id)
            form = form.model_copy(update={"seen": tag(now)})
    if reader.errors:
        return _page(errand, assignment, form=form, errors=reader.errors)
    return RedirectResponse(f"/class/rules/{assignment.id}?saved=rules", status_code=303)


@router.post("/{assignment_id}/extensions", dependencies=OWN_FORM)
def extend(
    errand: InstructorDep, assignment_id: AssignmentId, form: Annotated[ExtensionForm, Form()]
) -> Response:
    """Give one student more, or show the form again; an empty extension takes back what there was."""
    assignment = require_published(errand.services, errand.caller, assignment_id)
    known = course_rules(errand.services, errand.caller, assignment.id)
    student = form.student.strip()
    reader = Reader(known.zone)
    extension = reader.extension(form, known.extension(assignment.id, student))
    if not reader.errors:
        given = (assignment.id, student, extension, form.reason.strip())
        try:
            extend_for(errand.services, errand.caller, *given, seen=_seen(form, student))
        except RefusedError as error:
            if error.code == "unknown_student":
                reader.errors["student"] = "rules.error.student"
            elif error.code == "changed_meanwhile":
                reader.errors["form"] = EXTENDED_MEANWHILE
                now = errand.services.rules.of(errand.caller.course).extension(assignment.id, student)
                form = form.model_copy(update={"seen": tag(now), "seen_for": student})
            else:
                raise
    if reader.errors:
        return _page(errand, assignment, extension=form, extension_errors=reader.errors)
    return RedirectResponse(f"/class/rules/{assignment.id}?saved=extension#extensions", status_code=303)


def _page(  # noqa: PLR0913
    errand: PageErrand,
    assignment: Assignment,
    *,
    form: RuleForm | None = None,
    errors: dict[str, str] | None = None,
    extension: ExtensionForm | None = None,
    extension_errors: dict[str, str] | None = None,
    saved: str = "",
) -> Response:
    known = errand.services.rules.of(errand.caller.course)
    values: dict[str, Any] = {
        "assignment": assignment,
        "rules": known.of(assignment.id),
        "zone": known.zone,
        "form": form or _form(known, assignment.id),
        "errors": errors or {},
        "extensions": extensions(errand.services, errand.caller, assignment.id),
        "sections": _sections(errand, known, assignment.id),
        "extension": extension or _extension_form(known, assignment.id, ""),
        "tag": tag,
        "extension_errors": extension_errors or {},
        "names": names(errand.services, errand.caller),
        "may_change": errand.caller.is_instructor and errand.caller.course is not None,
        "short_fields": widgets(),
        "late_parameters": late_parameters(),
        "late_kinds": tuple(LATE_PARAMETERS),
        "counts": tuple(Counts),
        "correctors": tuple(Corrector),
        "hint_rules": tuple(HintRule),
        "shown": tuple(Shown),
        "saved": saved,
    }
    return page(
        errand.request, "rules_assignment.html", status=422 if errors or extension_errors else 200, **values
    )


def _sections(errand: PageErrand, known: CourseRules, assignment_id: str) -> list[tuple[str, str, str]]:
    """Return every section with its own due date (else nothing) and what lateness costs there."""
    rules, teller = known.of(assignment_id), Teller(errand.language, known.zone)
    own = {rule.section: teller.value("due", rule.due.isoformat()) for rule in rules.by_section}
    everybody = {*sections_of(members(errand.services, errand.caller)), *own}
    return [
        (name, own.get(name, ""), teller.late(asdict(rules.for_sections([name]).late), in_full=False))
        for name in sorted(everybody)
    ]


def _form(known: CourseRules, assignment_id: str) -> RuleForm:
    rules = known.of(assignment_id)
    return form_of(rules, known.zone, tag(rules))


def _extension_form(known: CourseRules, assignment_id: str, student: str) -> ExtensionForm:
    extension = known.extension(assignment_id, student)
    return extension_form_of(student, extension, known.zone, tag(extension))


def _seen(form: ExtensionForm, student: str) -> Seen | None:
    """Return which extension the form replaces: the one it was made from, or for another student none at all."""
    if not form.seen:
        return None
    return Seen.one(form.seen if form.seen_for == student else tag(NO_EXTENSION))
