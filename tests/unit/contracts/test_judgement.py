"""How judgements by people and a machine's points add up."""

from dataclasses import replace

import pytest

from grader.contracts.grading import GradingJob
from grader.contracts.judgement import composed, settled, standing
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemScore, ItemStatus
from grader.contracts.submission import Judgement
from grader.contracts.text import EMPTY, Text
from tests.fakes.clock import START
from tests.fakes.grading import assignment, grade


def given(revision: int, points: float, out_of: float = 5.0, item: str = "closed") -> Judgement:
    return Judgement(
        submission="s",
        item=item,
        revision=revision,
        points=points,
        out_of=out_of,
        comment="why",
        by="wang",
        at=START,
        attempt=1,
        source_sha256="",
    )


TAKEN_BACK = given(2, 0.0, 0.0)


@pytest.mark.parametrize(
    ("judgements", "revision"),
    [
        ((), None),
        ((given(1, 3.0), given(2, 4.0)), 2),
        ((given(1, 3.0), given(2, 4.0, 20.0)), 1),
        ((given(1, 3.0), TAKEN_BACK), None),
        ((given(1, 3.0), TAKEN_BACK, given(3, 4.0)), 3),
        ((given(1, 3.0, item="sides"),), None),
    ],
)
def test_the_latest_that_fits_and_was_not_taken_back_stands(
    judgements: tuple[Judgement, ...], revision: int | None
) -> None:
    found = standing("closed", 5.0, judgements)
    assert (None if found is None else found.revision) == revision


@pytest.mark.parametrize("machine", list(ItemStatus))
@pytest.mark.parametrize(
    ("points", "status"), [(0.0, ItemStatus.FAILED), (2.5, ItemStatus.PARTIAL), (5.0, ItemStatus.PASSED)]
)
def test_a_person_outranks_any_other_points_of_a_machine(
    machine: ItemStatus, points: float, status: ItemStatus
) -> None:
    earned = 1.0 if machine is ItemStatus.PARTIAL else 5.0 if machine is ItemStatus.PASSED else 0.0
    item = ItemScore("closed", 5.0, earned, machine)
    (whole,) = settled([item], [given(1, points)])
    same = machine is not ItemStatus.NEEDS_MANUAL and points == earned
    assert whole == (item if same else ItemScore("closed", 5.0, points, status))


def test_a_corrected_report_tells_both_and_keeps_how_the_script_ended() -> None:
    report = grade(GradingJob(file_name="a.py", source=b"good raise", assignment=assignment())).report
    whole = composed(report, [given(1, 2.5)])
    assert (whole.score, whole.status) == (7.5, GradeStatus.CRASHED)
    assert whole.items[0] == report.items[0]
    assert whole.items[1].message == Text(
        zh="教师把得分从 0 改为 2.5：why", en="A teacher changed the points from 0 to 2.5: why"
    )
    assert (whole.items[1].measured, whole.items[1].hint, whole.hint) == (
        4.0,
        report.items[1].hint,
        report.hint,
    )
    assert whole.summary.en == "A teacher corrected this: 7.5 / 10 points."
    assert composed(report, [given(1, 2.5), TAKEN_BACK]) is report


def test_what_was_corrected_to_full_points_leaves_nothing_to_be_done() -> None:
    report = grade(GradingJob(file_name="a.py", source=b"", assignment=assignment())).report
    hint = report.items[1].hint
    report = replace(
        report, hint=hint, items=(replace(report.items[0], hint=Text(zh="先", en="first")), report.items[1])
    )
    one = composed(report, [given(1, 5.0)])
    assert (one.items[1].hint, one.hint) == (EMPTY, EMPTY)
    other = composed(report, [given(1, 5.0, item="sides")])
    assert (other.items[0].hint, other.hint) == (EMPTY, hint)
