"""Use cases of the course decide by themselves who may, before they look anything up."""

from collections.abc import Callable
from typing import Any, cast

import pytest

from grader.contracts.appeal import AppealState
from grader.contracts.errors import RefusedError
from grader.contracts.identity import ANYBODY, Caller, Role
from grader.contracts.regrade import Wanted
from grader.contracts.rules import NO_EXTENSION, NO_RULES
from grader.store.appeals import AppealsWanted
from grader.store.judgements import WaitingFor
from grader.use_cases import appealing, dashboard, gradebook, judging, people, regrading, rules
from grader.use_cases.services import Services

NO_SERVICES = cast(Services, None)  # whatever is looked up fails with another error
SUBMISSION: Any = None
STUDENT, ASSISTANT = (
    Caller(course="ros", person=role.value, role=role) for role in (Role.STUDENT, Role.ASSISTANT)
)
UseCase = Callable[[Services, Caller], object]

STAFF: dict[str, UseCase] = {
    "all_regrades": regrading.all_regrades,
    "regrade_of": lambda services, caller: regrading.regrade_of(services, caller, "r"),
    "both_gradings": lambda services, caller: regrading.both_gradings(services, caller, "r", "s"),
    "history": lambda services, caller: regrading.history(services, caller, "s"),
    "past_grading": lambda services, caller: regrading.past_grading(services, caller, "s", 1),
    "waiting": lambda services, caller: judging.waiting(services, caller, WaitingFor(), offset=0, limit=1),
    "neighbours": lambda services, caller: judging.neighbours(services, caller, SUBMISSION, "timer"),
    "items_of": lambda services, caller: judging.items_of(services, caller, "s"),
    "give": lambda services, caller: judging.give(
        services, caller, "s", "timer", points=1.0, comment="", seen=None
    ),
    "appeals": lambda services, caller: appealing.queue(services, caller, AppealsWanted(), offset=0, limit=1),
    "answer": lambda services, caller: appealing.answer(
        services, caller, "s", "timer", appealing.AppealAnswer(state=AppealState.REFUSED, text="x"), seen=None
    ),
    "extensions": lambda services, caller: rules.extensions(services, caller, "square"),
    "book": gradebook.book,
    "gradebook_csv": lambda services, caller: gradebook.gradebook_csv(services, caller, "en", "plain"),
    "class_state": dashboard.class_state,
    "overview": lambda services, caller: dashboard.overview(services, caller, cast(Any, None), "en"),
    "members": people.members,
    "names": people.names,
}
INSTRUCTORS: dict[str, UseCase] = {
    "open_regrade": lambda services, caller: regrading.open_regrade(
        services, caller, Wanted(assignment="square")
    ),
    "decide": lambda services, caller: regrading.decide(services, caller, "r", "apply", "why"),
    "undo": lambda services, caller: regrading.decide(services, caller, "r", "undo", "why"),
    "course_rules": lambda services, caller: rules.course_rules(services, caller, "square"),
    "change_rules": lambda services, caller: rules.change_rules(
        services, caller, "square", NO_RULES, "", seen=None
    ),
    "extend": lambda services, caller: rules.extend(
        services, caller, "square", "li", NO_EXTENSION, "", seen=None
    ),
    "changes": lambda services, caller: people.changes(services, caller, None, 1),
}


def refused(use_case: UseCase, caller: Caller) -> str:
    with pytest.raises(RefusedError) as error:
        use_case(NO_SERVICES, caller)
    return error.value.code


@pytest.mark.parametrize("name", [*STAFF, *INSTRUCTORS])
def test_students_and_strangers_are_refused(name: str) -> None:
    use_case = (STAFF | INSTRUCTORS)[name]
    assert refused(use_case, STUDENT) == "forbidden"
    assert refused(use_case, ANYBODY) == "unauthorized"


@pytest.mark.parametrize("name", INSTRUCTORS)
def test_assistants_do_not_change_the_course(name: str) -> None:
    assert refused(INSTRUCTORS[name], ASSISTANT) == "forbidden"
