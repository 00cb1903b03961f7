"""One form that changes the rules of several assignments, or extends them for several people and sections."""

import dataclasses
import re
from datetime import datetime
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Form, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Role
from grader.contracts.rules import NO_EXTENSION, Corrector, Extension, LateRule, RuleError, Rules, Shown
from grader.service.web.access import InstructorDep, PageErrand, require_staff
from grader.service.web.forms import OWN_FORM
from grader.service.web.rule_form import Reader, typed_name
from grader.service.web.rule_pages import overview_page
from grader.use_cases.people import members
from grader.use_cases.rules import change_rules, course_rules, extend

router = APIRouter(prefix="/class/rules", include_in_schema=False, dependencies=[Depends(require_staff)])
_MOST = 200
_TYPED_FIELDS = ("opens", "due", "accept_late_s", "attempts", "attempts_per_day", "appeals_until")
_BETWEEN_IDS = re.compile(r"[\s,;，；、]+")


class SeveralForm(BaseModel):
    """What is typed. Empty fields of the rules leave what there is."""

    assignment: list[str] = Field(default_factory=list, max_length=_MOST)
    every: bool = False
    action: Literal["rules", "extensions"] = "rules"
    shown: Literal["", "always", "when_open", "draft"] = ""
    opens: str = Field(default="", max_length=40)
    due: str = Field(default="", max_length=40)
    late: Literal["", "none", "linear"] = ""
    per_day: str = Field(default="", max_length=40)
    accept_late: str = Field(default="", max_length=40)
    attempts: str = Field(default="", max_length=40)
    attempts_per_day: str = Field(default="", max_length=40)
    appeals_until: str = Field(default="", max_length=40)
    corrected_by: Literal["", "instructors", "staff"] = ""
    students: str = Field(default="", max_length=20_000)
    section: list[str] = Field(default_factory=list, max_length=_MOST)
    new_due: str = Field(default="", max_length=40)
    extra_attempts: str = Field(default="", max_length=40)
    reason: str = Field(default="", max_length=1_000)


@router.post("", dependencies=OWN_FORM)
def change_several(errand: InstructorDep, form: Annotated[SeveralForm, Form()]) -> Response:
    """Change what was chosen, all of it or nothing, or show the form again with what is wrong."""
    errors: dict[str, str] = {}
    if form.every:
        form = form.model_copy(update={"assignment": list(errand.assignments)})
    if not form.assignment:
        errors["assignment"] = "rules.error.no_assignment"
    elif form.action == "rules":
        errors = _change(errand, form)
    else:
        errors = _extend(errand, form)
    if errors:
        return overview_page(errand, form=form, errors=errors)
    return RedirectResponse("/class/rules?saved=1", status_code=303)


def _change(errand: PageErrand, form: SeveralForm) -> dict[str, str]:
    """Change the rules of the assignments; return what is wrong, by field."""
    known = {one: course_rules(errand.services, errand.caller, one) for one in form.assignment}
    reader = Reader(next(iter(known.values())).zone)
    values: dict[str, object] = {
        name: reader.typed(Rules, name, getattr(form, typed_name(name))) for name in _TYPED_FIELDS
    }
    per_day = reader.typed(LateRule, "per_day", form.per_day)
    if form.late == "none":
        values["late"] = LateRule()
    elif form.late == "linear" or per_day is not None:
        values["late"] = _linear(reader, per_day)
    values["shown"] = Shown(form.shown) if form.shown else None
    values["corrected_by"] = Corrector(form.corrected_by) if form.corrected_by else None
    given = {name: value for name, value in values.items() if value is not None}
    changed: dict[str, Rules] = {}
    for assignment, rules in known.items():
        try:
            changed[assignment] = dataclasses.replace(rules.of(assignment), **given)  # type: ignore[arg-type]
        except RuleError as error:
            reader.errors.setdefault(error.field, f"rules.error.{error.code}")
    if not reader.errors:
        for assignment, new in changed.items():
            change_rules(errand.services, errand.caller, assignment, new, form.reason.strip(), seen=None)
    return reader.errors


def _linear(reader: Reader, per_day: float | None) -> LateRule | None:
    try:
        return LateRule(kind="linear", per_day=per_day or 0.0)
    except RuleError as error:
        reader.errors.setdefault("per_day", f"rules.error.{error.code}")
        return None


def _extend(errand: PageErrand, form: SeveralForm) -> dict[str, str]:
    """Give several students more; return what is wrong, by field. What is left empty stays as each had it."""
    known = {one: course_rules(errand.services, errand.caller, one) for one in form.assignment}
    reader = Reader(next(iter(known.values())).zone)
    due: datetime | None = reader.typed(Extension, "due", form.new_due)
    extra: int | None = reader.typed(Extension, "extra_attempts", form.extra_attempts)
    errors = {("new_due" if name == "due" else name): key for name, key in reader.errors.items()}
    named = set(filter(None, _BETWEEN_IDS.split(form.students)))
    everybody = members(errand.services, errand.caller, Role.STUDENT)
    if named - {member.id for member in everybody}:
        errors["students"] = "rules.error.students"
    wanted = [
        member.id for member in everybody if member.id in named or set(member.sections) & set(form.section)
    ]
    if not wanted:
        errors.setdefault("students", "rules.error.nobody")
    if due is None and extra is None:
        errors.setdefault("new_due", "rules.error.no_extension")
    if errors:
        return errors
    for assignment, rules in known.items():
        for student in wanted:
            before = rules.extensions.get((assignment, student), NO_EXTENSION)
            more = Extension(
                due=before.due if due is None else due,
                extra_attempts=before.extra_attempts if extra is None else extra,
            )
            try:
                extend(
                    errand.services, errand.caller, assignment, student, more, form.reason.strip(), seen=None
                )
            except RefusedError as error:
                if error.code != "unknown_student":  # removed in between
                    raise
    return {}
