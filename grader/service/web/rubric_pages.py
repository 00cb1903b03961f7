"""The rubric of an assignment as a form: a course's own points, bands and texts."""

import math
from typing import Annotated

from fastapi import APIRouter, Depends, Form, Path, Response
from fastapi.responses import RedirectResponse
from pydantic import BaseModel, Field

from grader.contracts.assignment import Assignment, ItemSpec
from grader.contracts.errors import RefusedError
from grader.contracts.text import Text
from grader.service.web.access import InstructorDep, PageErrand, StaffDep, require_staff
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.use_cases.assignments import require_published
from grader.use_cases.rubric_changes import NewItem, change_rubric, is_changed, last_saved

router = APIRouter(prefix="/class/rubric", include_in_schema=False, dependencies=[Depends(require_staff)])
Id = Annotated[str, Path(max_length=64)]
_MOST_ITEMS = 100
_Column = Annotated[list[str], Field(max_length=_MOST_ITEMS)]


class RubricForm(BaseModel):
    """What is typed: of each column one value for each item, in the rubric's order."""

    brief_zh: str = Field(default="", max_length=5_000)
    brief_en: str = Field(default="", max_length=5_000)
    title_zh: _Column = []
    title_en: _Column = []
    points: _Column = []
    low: _Column = []
    high: _Column = []
    ramp: _Column = []


@router.get("/{assignment_id}")
def read(errand: StaffDep, assignment_id: Id) -> Response:
    """Show the rubric that the course uses, in a form."""
    assignment = require_published(errand.services, errand.caller, assignment_id)
    saved = last_saved(errand.services, errand.caller, assignment)
    return _page(errand, assignment, _filled(saved), refused=saved is not assignment)


@router.post("/{assignment_id}", dependencies=OWN_FORM)
def change(errand: InstructorDep, assignment_id: Id, form: Annotated[RubricForm, Form()]) -> Response:
    """Have a changed rubric examined, or show the form again with what is wrong."""
    assignment = require_published(errand.services, errand.caller, assignment_id)
    columns = (form.title_zh, form.title_en, form.points, form.low, form.high, form.ramp)
    if {len(column) for column in columns} != {len(assignment.items)}:
        return _page(errand, assignment, _filled(assignment), RefusedError("changed_meanwhile"))
    try:
        changes = [_change(number, row) for number, row in enumerate(zip(*columns, strict=True))]
        brief = Text(zh=form.brief_zh.strip(), en=form.brief_en.strip())
        change_rubric(errand.services, errand.caller, assignment_id, brief, changes)
    except RefusedError as error:
        return _page(errand, assignment, form, error)
    return RedirectResponse("/class/own?done=uploaded", status_code=303)


def _change(number: int, row: tuple[str, ...]) -> NewItem:
    title_zh, title_en, points, low, high, ramp = row
    return NewItem(
        title=Text(zh=title_zh.strip(), en=title_en.strip()),
        points=_number(points, f"items.{number}.points"),
        low=_number(low, f"items.{number}.low") if low.strip() else None,
        high=_number(high, f"items.{number}.high") if high.strip() else None,
        ramp=_number(ramp, f"items.{number}.ramp") if ramp.strip() else 0.0,
    )


def _number(typed: str, field: str) -> float:
    try:
        value = float(typed)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise RefusedError.saying(
            "invalid_assignment",
            zh=f"{field}：“{typed[:20]}”不是数",
            en=f"{field}: {typed[:20]!r} is no number",
            field=field,
        )
    return value


def _filled(assignment: Assignment) -> RubricForm:
    def column(name: str) -> list[str]:
        return [_typed(getattr(item, name)) for item in assignment.items]

    return RubricForm(
        brief_zh=assignment.brief.zh,
        brief_en=assignment.brief.en,
        title_zh=[item.title.zh for item in assignment.items],
        title_en=[item.title.en for item in assignment.items],
        points=column("points"),
        low=column("low"),
        high=column("high"),
        ramp=column("ramp"),
    )


def _typed(value: float | None) -> str:
    return "" if value is None else f"{value:.10g}"


def _has_band(item: ItemSpec) -> bool:
    """Whether an item is measured: others are a person's, or a share of expectations."""
    return not item.expect and (item.low is not None or item.high is not None)


def _page(
    errand: PageErrand,
    assignment: Assignment,
    form: RubricForm,
    error: RefusedError | None = None,
    *,
    refused: bool = False,
) -> Response:
    problem = None if error is None else form_problem(error, errand.language)
    return page(
        errand.request,
        "rubric_form.html",
        status=200 if problem is None else problem.status,
        assignment=assignment,
        form=form,
        banded=[_has_band(item) for item in assignment.items],
        changed=is_changed(errand.services, errand.caller, assignment),
        refused=refused,
        problem=problem,
        misfits=() if error is None else error.members.get("misfits", ()),
    )
