"""Points that people give for what no machine judges, or correct: what waits for them, and what they gave."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from grader.contracts.comment import LONGEST_COMMENT
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Seen
from grader.contracts.judgement import JudgedItem, standing
from grader.contracts.notation import written
from grader.contracts.report import report_from
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.rules import Corrector, is_hidden
from grader.contracts.submission import StoredReport, Submission
from grader.contracts.text import Text
from grader.store.judgements import Given, Neighbours, Waiting, WaitingFor, tag
from grader.use_cases.assignments import require_published
from grader.use_cases.callers import require_staff
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded, hiding, visible_submission

_ITEMS = Text(zh="写明要改的项目，每项一次。", en="Name the items to change, each once.")

MOST_PHRASES = 100
_LONGEST_KEY = 16
_PHRASES = Text(
    zh=f"每行先写键（最多 {_LONGEST_KEY} 个字符，不重复），空一格再写评语；最多 {MOST_PHRASES} 行。",
    en=f"Begin each line with a key (at most {_LONGEST_KEY} characters, none twice), then a space and the "
    f"comment; {MOST_PHRASES} lines at most.",
)
_DECIMALS = Text(zh="分数最多两位小数。", en="Points have at most two decimals.")


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitingPage:
    """Answers that wait for a person, question by question, each in order of arrival.

    Attributes:
        questions: how much of each question waits, by assignment and rubric item. total: of all of them.
        answers: one page of them.
    """

    questions: dict[tuple[str, str], int]
    answers: tuple[Waiting, ...]

    @property
    def total(self) -> int:
        """How many answers wait on all pages."""
        return sum(self.questions.values())


def waiting(services: Services, caller: Caller, which: WaitingFor, *, offset: int, limit: int) -> WaitingPage:
    """Return at most `limit` of what waits in the caller's course. For staff.

    Raises RefusedError: the caller may not see the class; or nothing waits, and there is no such assignment.
    """
    require_staff(caller)
    which = replace(which, students=caller.students)
    questions = services.judgements.questions(caller.course, which)
    if which.assignment is not None and not questions:
        require_published(services, caller, which.assignment, "unknown_assignment", field="assignment")
    return WaitingPage(
        questions=questions,
        answers=services.judgements.waiting(caller.course, which, offset, limit),
    )


def neighbours(services: Services, caller: Caller, submission: Submission, item: str | None) -> Neighbours:
    """Return which answers to the same question, or to the assignment, wait around a submission. For staff."""
    require_staff(caller)
    which = WaitingFor(assignment=submission.assignment, item=item, students=caller.students)
    return services.judgements.around(submission.course, which, submission.id, submission.received_at)


def phrases(services: Services, caller: Caller) -> dict[str, str]:
    """Return the comments that the course's staff use again, by key. For staff."""
    require_staff(caller)
    return services.phrases.of(caller.course)


def set_phrases(services: Services, caller: Caller, text: str) -> None:
    """Put the comments in `text`, a line each with its key and a space before it, in place of the course's.

    Raises:
        RefusedError: the caller is no staff of a course; or a key stands twice, a line has no comment, there are
            too many, or one is too long.
    """
    require_staff(caller)
    if caller.course is None:
        raise RefusedError("no_course")
    lines = [line.strip().partition(" ") for line in text.splitlines() if line.strip()]
    phrases = {key: words.strip() for key, _, words in lines}
    if len(phrases) < len(lines) or len(lines) > MOST_PHRASES:
        raise RefusedError("invalid_request", _PHRASES, field="phrases")
    if any(
        not words or len(key) > _LONGEST_KEY or len(words) > LONGEST_COMMENT for key, words in phrases.items()
    ):
        raise RefusedError("invalid_request", _PHRASES, field="phrases")
    services.phrases.set(phrases, services.signature(caller))


def items_of(
    services: Services, caller: Caller, submission_id: str
) -> tuple[Submission, tuple[JudgedItem, ...]]:
    """Return a submission and its rubric items with what people gave for them.

    Raises RefusedError: the caller may not see the class, there is no such submission, or no grading yet.
    """
    require_staff(caller)
    submission, stored = graded(services, caller, submission_id)
    return submission, judged_items(stored)


def judged_items(stored: StoredReport) -> tuple[JudgedItem, ...]:
    """Return the rubric items of a grading with what people gave for them."""
    return tuple(_judged(item, stored) for item in report_from(stored.content).items)


def give(  # noqa: PLR0913
    services: Services,
    caller: Caller,
    submission_id: str,
    item: str,
    *,
    points: float,
    comment: str,
    seen: Seen | None,
    answers: bool = False,
) -> None:
    """Keep the points and the comment that a person gives for an item in one of the states `seen`.

    None as `seen` means that nobody had judged the item. Assistants and instructors may. What the machine judged
    only those correct whom `may_correct` names, with a comment; the machine's own points take a correction back.
    `answers`: to an appeal, which must be open; one that is open is answered by any points.

    Raises:
        RefusedError: the points do not fit, there is no such item, the caller may not correct it, the reason is
            missing, or somebody judged it meanwhile.
    """
    _give(services, caller, submission_id, [(item, points, seen, comment)], answers=answers)


def give_several(
    services: Services,
    caller: Caller,
    submission_id: str,
    wanted: Sequence[tuple[str, float, Seen | None]],
    comment: str,
) -> None:
    """Keep points for several items with one comment, each as `give` does, all of them or none.

    Raises as `give`, naming the item; or one is named twice, or none at all.
    """
    give_each(services, caller, submission_id, [(*decision, comment) for decision in wanted])


def give_each(
    services: Services,
    caller: Caller,
    submission_id: str,
    wanted: Sequence[tuple[str, float, Seen | None, str]],
) -> None:
    """Keep points for several items, each with its own comment, as `give_several`."""
    names = [decision[0] for decision in wanted]
    if not names or len(set(names)) < len(names):
        raise RefusedError("invalid_request", _ITEMS, field="items")
    _give(services, caller, submission_id, wanted)


def _give(
    services: Services,
    caller: Caller,
    submission_id: str,
    wanted: Sequence[tuple[str, float, Seen | None, str]],
    *,
    answers: bool = False,
) -> None:
    require_staff(caller)
    submission = visible_submission(services, caller, submission_id)
    corrects = may_correct(services, caller, submission.assignment)
    judgements = []
    for item, points, seen, comment in wanted:
        if not math.isclose(points, round(points, 2), abs_tol=1e-9):
            raise RefusedError("invalid_points", _DECIMALS, field="points")
        text = comment.replace("\r\n", "\n")
        one = Given(item=item, points=round(points, 2), comment=text, corrects=corrects, answers=answers)
        judgements.append((one, seen))
    before = {item.id: item for item in judged_items(graded(services, caller, submission_id)[1])}
    asked = {appeal.item for appeal in services.appeals.of(submission_id) if appeal.is_open}
    services.judgements.judge_all(submission_id, judgements, services.signature(caller))
    corrected = [(before[one.item], one) for one, _ in judgements if one.item not in asked]
    _announce(services, caller, submission, corrected)


def _announce(
    services: Services, caller: Caller, submission: Submission, given: Sequence[tuple[JudgedItem, Given]]
) -> None:
    """Tell the student of corrections by a comment; of answers to appeals they are told otherwise."""
    hidden = hiding(services, submission).items
    lines = [
        f"{item.title.zh} / {item.title.en}: {written(_counting(item))} → {written(one.points)} / "
        f"{written(item.points)}"
        for item, one in given
        if item.machine is not None and not is_hidden(item.id, hidden)
    ]
    if lines and caller.course is not None:
        text = "\n".join([*lines, given[0][1].comment])[:LONGEST_COMMENT]
        services.comments.add(submission.id, text, None, services.signature(caller), by_student=False)


def _counting(item: JudgedItem) -> float:
    return item.judgement.points if item.judgement is not None else item.machine or 0.0


def may_correct(services: Services, caller: Caller, assignment: str) -> bool:
    """Return whether the caller may correct the machine's points: instructors, or all staff, as the rules say."""
    rules = services.rules.of(caller.course).of(assignment)
    return caller.is_instructor or (caller.is_staff and rules.corrected_by is Corrector.STAFF)


def _judged(item: RubricItem, stored: StoredReport) -> JudgedItem:
    own = tuple(judgement for judgement in stored.judgements if judgement.item == item.id)
    return JudgedItem(
        id=item.id,
        title=item.title,
        points=item.points,
        machine=None if item.status is ItemStatus.NEEDS_MANUAL else item.earned,
        judgement=standing(item.id, item.points, own),
        history=own,
        tag=tag(own[-1] if own else None, stored.sha256),
    )
