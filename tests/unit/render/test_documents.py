"""Exports hold only fields that the platforms document, and never turn our fault into a zero."""

import json

import pytest

from grader.contracts.report import GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.render.documents import to_gradescope, to_prairielearn
from tests.unit.render.samples import crash, item, outcome, report, square_report, t

GRADESCOPE = {
    "score", "execution_time", "output", "output_format", "test_output_format", "test_name_format",
    "visibility", "stdout_visibility", "extra_data", "tests", "leaderboard",
}  # fmt: skip
GRADESCOPE_TEST = {
    "score", "max_score", "status", "name", "name_format", "number", "output", "output_format", "tags",
    "visibility", "extra_data",
}  # fmt: skip
PRAIRIELEARN = {"score", "gradable", "format_errors", "message", "output", "images", "tests"}
PRAIRIELEARN_TEST = {"name", "description", "points", "max_points", "message", "output", "images"}
HOSTILE = "\x00\x1b[31m\u202e<script>"


def hostile_report() -> GradeReport:
    line = item(ItemStatus.FAILED, title=t(HOSTILE), message=t(HOSTILE), hint=t(HOSTILE))
    return report(items=(line,), summary=t(HOSTILE), hint=t(HOSTILE))


def test_gradescope_fields() -> None:
    document = to_gradescope(square_report())
    tests = document["tests"]
    assert isinstance(tests, list)
    assert set(document) <= GRADESCOPE
    assert document["score"] == 7.25
    assert document["visibility"] == "visible"
    for test in tests:
        assert set(test) <= GRADESCOPE_TEST
        assert test["status"] in {"passed", "failed"}
        assert 0 <= test["score"] <= test["max_score"]
        assert test["visibility"] == "visible"  # one hidden test would hide the total
    assert [test["status"] for test in tests] == ["passed", "failed", "passed", "failed", "failed"]
    assert "第 3 条边 1.62 m" in tests[1]["output"]


def test_gradescope_sums_the_tests_until_a_person_has_graded() -> None:
    items = (item(), item(ItemStatus.NEEDS_MANUAL, id="essay"))
    document = to_gradescope(report(score=None, status=GradeStatus.NEEDS_MANUAL, items=items))
    assert "score" not in document
    assert [test.get("score") for test in document["tests"]] == [2.0, None]
    assert "status" not in document["tests"][1]


def test_prairielearn_fields() -> None:
    document = to_prairielearn(square_report(), "en")
    assert set(document) <= PRAIRIELEARN
    assert document["score"] == pytest.approx(0.725)
    tests = document["tests"]
    assert isinstance(tests, list)
    for test in tests:
        assert set(test) <= PRAIRIELEARN_TEST
    assert tests[1]["description"] == "Wanted: at most 5 %"


@pytest.mark.parametrize(("score", "share"), [(0.0, 0.0), (10.0, 1.0), (11.0, 1.0)])
def test_prairielearn_score_is_a_share(score: float, share: float) -> None:
    assert to_prairielearn(report(score=score))["score"] == share


def test_the_students_own_error_is_there() -> None:
    crashed = report(score=0.0, status=GradeStatus.CRASHED, outcome=outcome(error=crash()))
    for document in (to_gradescope(crashed), to_prairielearn(crashed)):
        assert "msg.linear.x = 1" in str(document["output"])


def test_documents_are_json_without_control_characters() -> None:
    for document in (to_gradescope(hostile_report()), to_prairielearn(hostile_report())):
        text = json.dumps(document, allow_nan=False, ensure_ascii=False)
        assert "\\u0000" not in text
        assert "\\u001b" not in text
        assert "\u202e" not in text
