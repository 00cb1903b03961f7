"""The service check: what became of the assignment's calls."""

from dataclasses import replace
from typing import Any

import pytest

from grader.checks import evaluate, problems, sketch
from grader.contracts.outcome import Endpoint, RunOutcome, RunStatus, ServiceResult
from grader.contracts.rubric import ItemStatus
from grader.contracts.scoring import Run, Scoring
from tests.unit.checks.shipped import assignment, item, score
from tests.unit.checks.trajectories import drive

TASK = assignment("rosclaw")
CALL = TASK.calls[0]
SECOND = 1_000_000_000
OWN = Endpoint(
    kind="service", node="/n", name="/n/get_parameters", type="rcl_interfaces/srv/GetParameters", count=0
)


def judged(
    result: ServiceResult | None,
    *,
    services: tuple[tuple[str, str], ...] = (),
    source: str = "",
    **outcome: Any,
) -> Scoring:
    endpoints = tuple(
        Endpoint(kind="service", node="/n", name=name, type=kind, count=0) for name, kind in services
    )
    values: dict[str, Any] = {
        "status": RunStatus.INTERRUPTED,
        "duration_ns": 10 * SECOND,
        "nodes": ("/n",),
        "endpoints": (OWN, *endpoints),
    }
    calls = () if result is None else (result,)
    run = Run(trajectory=drive([]), outcome=RunOutcome(**{**values, **outcome}), calls=calls, source=source)
    return evaluate(TASK, [run])


def answered(**values: Any) -> ServiceResult:
    return ServiceResult(call=CALL, sent_ns=2 * SECOND, answered_ns=2 * SECOND, values=values)


RIGHT = ((CALL.service, CALL.type),)


def test_an_answer_with_entries_earns_everything() -> None:
    scoring = judged(answered(capabilities=["camera", "speak"]), services=RIGHT)
    assert score(scoring) == 100
    assert "camera, speak" in item(scoring, "capabilities").message.en


@pytest.mark.parametrize("entries", [["camera", "camera"], ["camera", "  "], ["camera"]])
def test_only_different_and_filled_entries_count(entries: list[str]) -> None:
    scoring = judged(answered(capabilities=entries), services=RIGHT)
    assert item(scoring, "capabilities").measured == 1
    assert item(scoring, "capabilities").status is ItemStatus.PARTIAL


@pytest.mark.parametrize(
    ("services", "code"),
    [
        ((), "no_service"),
        ((("/get_capabilities", CALL.type),), "wrong_service_name"),
        (((CALL.service, "std_srvs/srv/Trigger"),), "wrong_service_type"),
    ],
)
def test_a_service_that_was_not_found_is_explained(services: tuple[tuple[str, str], ...], code: str) -> None:
    scoring = judged(ServiceResult(call=CALL), services=services)
    assert item(scoring, "offered").status is ItemStatus.FAILED
    assert item(scoring, "answered").status is ItemStatus.NOT_CHECKED
    assert scoring.mistakes == (code,)


def test_a_node_that_ended_before_the_call_is_told_to_spin() -> None:
    scoring = judged(
        ServiceResult(call=CALL), services=RIGHT, status=RunStatus.FINISHED, duration_ns=SECOND // 10
    )
    assert scoring.mistakes == ("not_spinning",)


def test_a_call_without_an_answer() -> None:
    scoring = judged(ServiceResult(call=CALL, sent_ns=2 * SECOND), services=RIGHT)
    assert scoring.mistakes == ("service_silent",)
    assert item(scoring, "offered").status is ItemStatus.PASSED


def test_a_call_of_another_type_than_the_service_has() -> None:
    other = ((CALL.service, "std_srvs/srv/Trigger"),)
    scoring = judged(ServiceResult(call=CALL, sent_ns=2 * SECOND), services=other)
    assert scoring.mistakes == ("wrong_service_type",)


def test_an_executor_without_the_node_answers_nothing() -> None:
    source = "executor = SingleThreadedExecutor()\nexecutor.spin()\n"
    scoring = judged(ServiceResult(call=CALL, sent_ns=2 * SECOND), services=RIGHT, source=source)
    assert scoring.mistakes == ("executor_without_node",)


@pytest.mark.parametrize("listed", [[], ["", " "]])
def test_an_empty_answer(listed: list[str]) -> None:
    scoring = judged(answered(capabilities=listed), services=RIGHT)
    assert scoring.mistakes == ("empty_answer",)
    assert score(scoring) == 80


def test_no_node_and_no_calls_earn_nothing_and_raise_nothing() -> None:
    assert score(judged(None, nodes=(), status=RunStatus.FINISHED)) == 0


def test_the_plot_shows_logs() -> None:
    run = Run(trajectory=drive([]), outcome=RunOutcome(status=RunStatus.FINISHED, duration_ns=0))
    assert sketch(TASK, run).view == "log"


def test_calls_and_field_must_be_given() -> None:
    assert "calls" in dict(problems(replace(TASK, calls=())))
    assert "options.list_field" in dict(problems(replace(TASK, options={})))
    assert "options.list_field" in dict(problems(replace(TASK, options={"list_field": "a b"})))
    assert "calls" in dict(problems(replace(assignment("square"), calls=TASK.calls)))
