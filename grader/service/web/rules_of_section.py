"""The form for the rule of one section of the course for an assignment."""

from typing import Annotated

from fastapi import APIRouter, Depends, Form, Query, Request, Response
from fastapi.responses import RedirectResponse

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import LONGEST_SECTION, Seen
from grader.contracts.rules import LATE_PARAMETERS, RuleError, Rules, SectionRule
from grader.service.web.access import AssignmentId, InstructorDep, require_staff
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.service.web.rule_form import (
    CHANGED_MEANWHILE,
    Reader,
    RuleForm,
    form_of,
    late_parameters,
    widgets,
)
from grader.store.rules import CourseRules, tag
from grader.use_cases.assignments import require_published
from grader.use_cases.rules import change_rules, course_rules

router = APIRouter(prefix="/class/rules", include_in_schema=False, dependencies=[Depends(require_staff)])
SectionName = Annotated[str, Query(alias="name", min_length=1, max_length=LONGEST_SECTION)]


@router.get("/{assignment_id}/section")
def read(errand: InstructorDep, assignment_id: AssignmentId, section: SectionName) -> Response:
    """Show due date and late rule of a section; those of the course if it has none of its own."""
    assignment = require_published(errand.services, errand.caller, assignment_id)
    known = course_rules(errand.services, errand.caller, assignment.id)
    return _page(errand.request, known, assignment, section)


@router.post("/{assignment_id}/section", dependencies=OWN_FORM)
def change(
    errand: InstructorDep,
    assignment_id: AssignmentId,
    section: SectionName,
    form: Annotated[RuleForm, Form()],
    remove: Annotated[bool, Form()] = False,
) -> Response:
    """Set or remove the section's rule; if something is wrong, show the form again."""
    assignment = require_published(errand.services, errand.caller, assignment_id)
    known = course_rules(errand.services, errand.caller, assignment.id)
    reader = Reader(known.zone)
    rules = known.of(assignment.id)
    changed = rules.with_section(section, None) if remove else _typed(reader, form, rules, section)
    if not reader.errors:
        seen, reason = Seen.one(form.seen) if form.seen else None, form.reason.strip()
        try:
            change_rules(errand.services, errand.caller, assignment.id, changed, reason, seen=seen)
        except RefusedError as error:
            if error.code != "changed_meanwhile":
                raise
            reader.errors["form"] = CHANGED_MEANWHILE
            known = errand.services.rules.of(errand.caller.course)
            form = form.model_copy(update={"seen": tag(known.of(assignment.id))})
    if reader.errors:
        return _page(errand.request, known, assignment, section, form, reader.errors)
    return RedirectResponse(f"/class/rules/{assignment.id}?saved=rules#by-section", status_code=303)


def _typed(reader: Reader, form: RuleForm, rules: Rules, section: str) -> Rules:
    """Return the rules with the section's rule as typed; unchanged, with an error in `reader`, if it is wrong."""
    typed = reader.rules(form, _shown(rules, section), frozenset())
    if typed.due is None:
        reader.errors.setdefault("due", "rules.error.needs_due")
    if reader.errors or typed.due is None:
        return rules
    rule = SectionRule(section=section, due=typed.due, late=typed.late, accept_late_s=typed.accept_late_s)
    try:
        return rules.with_section(section, rule)
    except RuleError as error:
        reader.errors["due"] = f"rules.error.{error.code}"
        return rules


def _shown(rules: Rules, section: str) -> Rules:
    """Return the rules that the form shows: those fields that a section may have of its own."""
    own = rules.for_sections([section])
    return Rules(due=own.due, late=own.late, accept_late_s=own.accept_late_s)


def _page(  # noqa: PLR0913, PLR0917
    request: Request,
    known: CourseRules,
    assignment: Assignment,
    section: str,
    form: RuleForm | None = None,
    errors: dict[str, str] | None = None,
) -> Response:
    rules = known.of(assignment.id)
    return page(
        request,
        "rules_section.html",
        status=422 if errors else 200,
        assignment=assignment,
        section=section,
        zone=known.zone,
        form=form or form_of(_shown(rules, section), known.zone, tag(rules)),
        errors=errors or {},
        has_rule=any(rule.section == section for rule in rules.by_section),
        short_fields=widgets(),
        late_parameters=late_parameters(),
        late_kinds=tuple(LATE_PARAMETERS),
    )
