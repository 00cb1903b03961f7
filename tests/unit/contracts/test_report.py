"""The one byte form of a report."""

import json
from dataclasses import replace
from math import nan
from typing import Any

import pytest

from grader.contracts.record import from_plain
from grader.contracts.report import GradeReport
from grader.contracts.rubric import ItemStatus
from tests.unit.render.samples import crash, item, outcome, report, square_report, t

REPORTS = [
    square_report(),
    report(items=(item(ItemStatus.FAILED, title=t("\x00\u202e<'\"\\方"), measured=-0.0, target=1e-7),)),
    report(items=(), mistakes=("b", "a"), score=None),
    report(runs=(replace(square_report().runs[0], outcome=outcome(error=crash())),)),
]


@pytest.mark.parametrize("one", REPORTS)
def test_canonical_bytes_are_the_sorted_json_of_all_fields(one: GradeReport) -> None:
    plain = json.dumps(one.to_dict(), ensure_ascii=False, sort_keys=True, separators=(",", ":"))
    assert one.canonical_bytes() == plain.encode()
    assert from_plain(GradeReport, json.loads(one.canonical_bytes())) == one


@pytest.mark.parametrize(("part", "error"), [(nan, ValueError), (object(), TypeError), ({1, 2}, TypeError)])
def test_what_has_no_canonical_form_is_refused(part: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        replace(square_report(), max_score=part).canonical_bytes()
