"""What people judge and correct, as the interface shows it."""

from collections.abc import Iterable, Mapping
from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from grader.contracts.assignment import Assignment
from grader.contracts.judgement import LONGEST_COMMENT, standing
from grader.contracts.report import GradeReport
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.submission import Judgement, StoredReport, Submission
from grader.contracts.text import Language
from grader.routes.dependencies import SUBMISSIONS, Number
from grader.store.judgements import Waiting, tag
from grader.use_cases.assignments import item_title


class JudgementBody(BaseModel):
    """What a person gives for one rubric item."""

    model_config = ConfigDict(extra="forbid")

    points: Annotated[
        Number,
        Field(
            ge=0.0,
            allow_inf_nan=False,
            description="From 0 to the most the item can earn, with at most two decimals.",
            examples=[22.5],
        ),
    ]
    comment: Annotated[
        str,
        Field(
            max_length=LONGEST_COMMENT,
            pattern=r"^[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f]*$",
            description="For the student, in place of the sentence that says that somebody graded this. Required "
            "where the machine judged.",
            examples=["What a timer does is right; say also who calls the callback."],
        ),
    ] = ""


class JudgementView(BaseModel):
    """What somebody gave."""

    revision: int = Field(description="1 for the first judgement of the item.", examples=[1])
    points: float = Field(examples=[22.5])
    out_of: float = Field(
        description="Most the item could earn then; 0: earlier corrections were taken back.", examples=[45.0]
    )
    comment: str
    by: str = Field(examples=["wang"])
    at: datetime
    attempt: int = Field(description="Number of the grading that was looked at.", examples=[1])
    source_sha256: str = Field(description="Digest of the answer that was judged.")


class ManualItemView(BaseModel):
    """One rubric item, and what people gave for it."""

    item: str = Field(examples=["timer"])
    title: str = Field(examples=["What create_timer does"])
    points: float = Field(description="Most it can earn.", examples=[45.0])
    machine: float | None = Field(
        description="What the machine gave; null: it leaves the item to people.", examples=[None]
    )
    waits: bool = Field(
        description="It is left to people, and nobody has judged it yet, or not since it has these points."
    )
    judgement: JudgementView | None = Field(
        description="The one that counts; null while it waits, or while the machine's points count."
    )
    history: list[JudgementView] = Field(description="All, oldest first.")
    etag: str = Field(
        description="Of this state: to be sent as If-Match with the next judgement.",
        examples=['"0.9f86d081884c7d65"'],
    )


class ManualItemsView(BaseModel):
    """The rubric items of one submission, and what people gave for them."""

    submission: str = Field(description="Its address.")
    source: str = Field(description="Address of the answer as it was handed in.")
    student: str = Field(examples=["20260123"])
    assignment: str = Field(examples=["theory_publisher_timer"])
    score: float | None = Field(description="Null while something waits.", examples=[82.5])
    max_score: float | None = Field(examples=[100.0])
    items: list[ManualItemView]


class QuestionView(BaseModel):
    """How many answers to one question wait."""

    assignment: str = Field(examples=["theory_publisher_timer"])
    assignment_title: str = Field(examples=["Question: publisher and timer"])
    item: str = Field(examples=["timer"])
    title: str = Field(examples=["What create_timer does"])
    waiting: int = Field(examples=[17])


class WaitingView(BaseModel):
    """One rubric item of one submission that waits for a person."""

    submission: str = Field(description="Its address.")
    source: str = Field(description="Address of the answer as it was handed in.")
    judgement: str = Field(description="Address to put points to.")
    student: str | None = Field(description="Null when names are left out.", examples=["20260123"])
    assignment: str = Field(examples=["theory_publisher_timer"])
    item: str = Field(examples=["timer"])
    title: str = Field(examples=["What create_timer does"])
    points: float = Field(description="Most it can earn.", examples=[45.0])
    received_at: datetime


class WaitingList(BaseModel):
    """A page of what waits for a person: question by question, each in order of arrival."""

    total: int = Field(description="Of all pages.", examples=[34])
    questions: list[QuestionView] = Field(description="All that have something waiting.")
    waiting: list[WaitingView]


def manual_items(
    submission: Submission, stored: StoredReport, machine: GradeReport, language: Language
) -> ManualItemsView:
    """Return what people gave for a submission's items; `machine` is its report without their points."""
    own = SUBMISSIONS + submission.id
    return ManualItemsView(
        submission=own,
        source=f"{own}/source",
        student=submission.student,
        assignment=submission.assignment,
        score=submission.score,
        max_score=submission.max_score,
        items=[_item(item, stored, language) for item in machine.items],
    )


def waiting_list(
    entries: Iterable[Waiting],
    questions: Mapping[tuple[str, str], int],
    published: Mapping[str, Assignment],
    language: Language,
    *,
    anonymous: bool,
) -> WaitingList:
    """Return a page of the list, with titles of what is still published."""
    return WaitingList(
        total=sum(questions.values()),
        questions=[
            QuestionView(
                assignment=assignment,
                assignment_title=_assignment_title(published.get(assignment), assignment, language),
                item=item,
                title=item_title(published.get(assignment), item, language),
                waiting=count,
            )
            for (assignment, item), count in questions.items()
        ],
        waiting=[
            WaitingView(
                submission=SUBMISSIONS + one.submission,
                source=f"{SUBMISSIONS}{one.submission}/source",
                judgement=f"{SUBMISSIONS}{one.submission}/judgements/{one.item}",
                student=None if anonymous else one.student,
                assignment=one.assignment,
                item=one.item,
                title=item_title(published.get(one.assignment), one.item, language),
                points=one.points,
                received_at=one.received_at,
            )
            for one in entries
        ],
    )


def _item(item: RubricItem, stored: StoredReport, language: Language) -> ManualItemView:
    own = [one for one in stored.judgements if one.item == item.id]
    counting = standing(item.id, item.points, own)
    manual = item.status is ItemStatus.NEEDS_MANUAL
    return ManualItemView(
        item=item.id,
        title=item.title.get(language),
        points=item.points,
        machine=None if manual else item.earned,
        waits=manual and counting is None,
        judgement=None if counting is None else _judgement(counting),
        history=[_judgement(one) for one in own],
        etag=f'"{tag(own[-1] if own else None, stored.sha256)}"',
    )


def _judgement(one: Judgement) -> JudgementView:
    return JudgementView(
        revision=one.revision,
        points=one.points,
        out_of=one.out_of,
        comment=one.comment,
        by=one.by,
        at=one.at,
        attempt=one.attempt,
        source_sha256=one.source_sha256,
    )


def _assignment_title(published: Assignment | None, assignment: str, language: Language) -> str:
    return assignment if published is None else published.title.get(language)
