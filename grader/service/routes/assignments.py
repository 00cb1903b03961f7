"""The published side of assignments: what is asked and what it earns."""

from typing import Annotated, Any

from fastapi import APIRouter, Path, Response
from pydantic import Field

from grader.checks import published_rubric
from grader.contracts.assignment import Assignment, Distro, ItemSpec, RunsAs
from grader.contracts.rubric import PublishedItem
from grader.contracts.text import Language
from grader.service.requests.dependencies import ErrandDep, LanguageDep
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases.assignments import checklist, visible_assignment

router = APIRouter(prefix="/api/v1/assignments", tags=["assignments"])


class AssignmentSummary(View):
    """One exercise of the checklist."""

    id: str = Field(examples=["square"])
    order: int = Field(description="Position on the checklist.", examples=[5])
    version: int = Field(examples=[1])
    title: str = Field(examples=["Drive a square"])
    brief: str = Field(description="What to do.")
    max_score: float = Field(examples=[10.0])
    horizon_s: float | None = Field(
        description="Virtual seconds until Ctrl+C; null for a text, which is not run.", examples=[60.0]
    )
    url: str = Field(examples=["/api/v1/assignments/square"])


class ItemView(View):
    """One rubric item as published."""

    id: str = Field(examples=["sides"])
    title: str = Field(examples=["Number of sides"])
    points: float = Field(examples=[5.0])
    measure: str = Field(description="The quantity that is judged.", examples=["sides"])
    low: float | None = Field(description="Full credit from here; null: no lower bound.", examples=[4.0])
    high: float | None = Field(description="Full credit up to here; null: no upper bound.", examples=[4.0])
    ramp: float = Field(
        description="Credit falls to zero over this distance outside; 0: at once.", examples=[0.0]
    )
    needs: list[str] = Field(
        description="Items that must not have failed; with less than half of their points this counts in part.",
        examples=[[]],
    )
    looks_at: str = Field(description="What is measured, in words.", examples=["the number of sides"])
    wanted: str = Field(description="What earns full credit, in words.", examples=["4"])
    partial: str = Field(description="Where credit ends, in words.", examples=["All or nothing."])


class CaseView(View):
    """One run of the script."""

    id: str = Field(examples=["default"])
    title: str
    args: list[str] = Field(description="Command line arguments.", examples=[[]])


class AssignmentView(AssignmentSummary):
    """An exercise with its whole rubric."""

    file_patterns: list[str] = Field(description="File names that tell it.", examples=[["*square*.py"]])
    distro: Distro = Field(description="Release of ROS 2 that a script finds.")
    runs_as: RunsAs = Field(
        description="How a script is started: by python3, or as ros2 run calls its main()."
    )
    cmd_vel_topic: str = Field(description="Topic that moves the car.", examples=["/turtle1/cmd_vel"])
    walls: bool = Field(description="Whether the window's edges stand as walls.")
    cpu_limit_s: float = Field(description="CPU seconds a run may use.", examples=[10.0])
    memory_limit_bytes: int = Field(examples=[536_870_912])
    rubric: list[ItemView] = Field(description="Made from the data that the scores come from.")
    remarks: str = Field(description="How this kind of exercise is looked at.")
    cases: list[CaseView]


class AssignmentList(View):
    """All exercises in the order of the checklist."""

    assignments: list[AssignmentSummary]


@router.get("", summary="All assignments", responses=responses("invalid_request"))
def list_all(errand: ErrandDep, response: Response, language: LanguageDep) -> AssignmentList:
    """Return the checklist."""
    _set_language(response, language)
    return AssignmentList(
        assignments=[
            AssignmentSummary.of(assignment, **_summary(assignment, language))
            for assignment in checklist(errand.services, errand.caller)
        ]
    )


@router.get(
    "/{assignment_id}",
    summary="One assignment with its rubric",
    responses=responses("assignment_not_found", "invalid_request"),
)
def read(
    errand: ErrandDep,
    response: Response,
    language: LanguageDep,
    assignment_id: Annotated[str, Path(max_length=64, examples=["square"])],
) -> AssignmentView:
    """Return what an assignment asks for and how each item earns its points."""
    assignment = visible_assignment(errand.services, errand.caller, assignment_id)
    _set_language(response, language)
    published = published_rubric(assignment)
    return AssignmentView.of(
        assignment,
        **_summary(assignment, language),
        distro=assignment.release,
        runs_as=assignment.started_as,
        cmd_vel_topic=assignment.world.cmd_vel_topic,
        walls=assignment.world.window,
        cpu_limit_s=assignment.limits.cpu_s,
        memory_limit_bytes=assignment.limits.memory_bytes,
        rubric=[
            _item(item, words, language)
            for item, words in zip(assignment.items, published.items, strict=True)
        ],
        remarks=published.remarks.get(language),
        cases=[CaseView.of(case, title=case.title.get(language)) for case in assignment.cases],
    )


def _summary(assignment: Assignment, language: Language) -> dict[str, Any]:
    return {
        "title": assignment.title.get(language),
        "brief": assignment.brief.get(language),
        "horizon_s": None if assignment.input == "text" else assignment.horizon_s,
        "url": f"/api/v1/assignments/{assignment.id}",
    }


def _item(item: ItemSpec, words: PublishedItem, language: Language) -> ItemView:
    return ItemView.of(
        item,
        title=item.title.get(language),
        looks_at=words.measure.get(language),
        wanted=words.wanted.get(language),
        partial=words.partial.get(language),
    )


def _set_language(response: Response, language: Language) -> None:
    response.headers.update({"Content-Language": language, "Vary": "Accept-Language"})
