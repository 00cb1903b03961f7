"""The entry point: dependencies, several cases, the published rubric, and assignments that do not fit."""

from dataclasses import replace

import pytest

from grader.catalog import Catalog
from grader.checks import evaluate, problems, published_rubric
from grader.checks.kinds import CHECKS
from grader.checks.measure import MeasureKind
from grader.contracts.assignment import Assignment, Case, ItemSpec
from grader.contracts.errors import AssignmentError
from grader.contracts.rubric import ItemStatus
from grader.contracts.scoring import Run
from grader.contracts.text import LANGUAGES, Text
from tests.unit.checks.shipped import assignment, graded, item, score
from tests.unit.checks.trajectories import drive, outcome_of, polygon_legs, run_of

SHIPPED = Catalog().all()


@pytest.mark.parametrize("shipped", SHIPPED, ids=lambda each: each.id)
def test_shipped_assignments_fit_their_checks(shipped: Assignment) -> None:
    assert problems(shipped) == ()
    assert shipped.max_score == 100


def test_items_stand_in_the_order_of_the_rubric() -> None:
    scoring = graded("square", drive(polygon_legs(4)))
    assert [each.id for each in scoring.items] == [spec.id for spec in assignment("square").items]


def test_not_checked_spreads_along_dependencies_and_names_them() -> None:
    scoring = graded("square", drive([(3.0, 1.0, 0.0)]))
    assert item(scoring, "sides").status is ItemStatus.FAILED
    lengths = item(scoring, "lengths")
    assert lengths.status is ItemStatus.NOT_CHECKED
    assert lengths.measured is None
    assert "Number of sides" in lengths.message.en


def test_what_rests_on_little_counts_in_part_and_says_so() -> None:
    scoring = graded("square", drive(polygon_legs(4, corners_deg=[90, 107, 90, 90])))
    angles, lengths = item(scoring, "angles"), item(scoring, "lengths")
    share = angles.earned / angles.points / 0.5
    assert 0 < share < 1
    assert lengths.status is ItemStatus.PARTIAL
    assert abs(lengths.earned - share * lengths.points) <= 0.02
    assert lengths.message.en.startswith("Longest side 2 m, shortest 2 m")
    assert "counts for 36.1 % only" in lengths.message.en
    assert lengths.message.en.endswith("Corner angles.")
    assert lengths.hint.en == ""  # the sides are right
    assert "Equal sides" not in scoring.summary.en
    half = graded("square", drive(polygon_legs(4, corners_deg=[90, 98, 90, 90])))
    assert item(half, "lengths").earned == lengths.points


def test_a_measure_in_an_unknown_unit_is_told_before_anything_is_graded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    measures = {**CHECKS["rotation"].measures, "turned_deg": MeasureKind("furlong")}  # type: ignore[arg-type]
    monkeypatch.setattr("grader.checks.KINDS", {"rotation": replace(CHECKS["rotation"], measures=measures)})
    ((field, told),) = problems(assignment("spin"))
    assert field == "items.1.measure"
    assert "'furlong'" in told.en
    assert "'furlong'" in told.zh


def test_several_cases_divide_the_points() -> None:
    square = replace(assignment("square"), cases=(Case(id="short"), Case(id="long")))
    right, wrong = drive(polygon_legs(4)), drive([], horizon_s=1.0)
    runs = [
        Run(case="short", trajectory=right, outcome=outcome_of(right)),
        Run(case="long", trajectory=wrong, outcome=outcome_of(wrong)),
    ]
    scoring = evaluate(square, runs)
    assert score(scoring) == 50
    assert scoring.items[0].id == "short/moves"
    assert sum(each.points for each in scoring.items) == square.max_score


def test_the_same_run_gets_the_same_verdict() -> None:
    run = run_of(drive(polygon_legs(4, corners_deg=[90, 96, 90, 90])))
    assert evaluate(assignment("square"), [run]) == evaluate(assignment("square"), [run])


def test_summary_counts() -> None:
    scoring = graded("square", drive(polygon_legs(4, lengths_m=[2, 2, 1.5, 2])))
    assert "8 项中 6 项通过" in scoring.summary.zh
    assert "6 of 8" in scoring.summary.en
    assert "Equal sides, Back to the start" in scoring.summary.en
    assert "0/100" in graded("square", drive([], horizon_s=1.0)).summary.zh


@pytest.mark.parametrize("shipped", SHIPPED, ids=lambda each: each.id)
def test_published_rubric_is_complete(shipped: Assignment) -> None:
    rubric = published_rubric(shipped)
    assert sum(each.points for each in rubric.items) == rubric.max_score == 100
    for each, spec in zip(rubric.items, shipped.items, strict=True):
        assert (each.id, each.points) == (spec.id, spec.points)
        for language in LANGUAGES:
            assert each.measure.get(language)
            assert each.wanted.get(language)
            assert each.partial.get(language)
            assert bool(each.needs.get(language)) == bool(spec.needs)


def test_published_rubric_says_the_numbers_scored_by() -> None:
    items = {each.id: each for each in published_rubric(assignment("triangle")).items}
    assert items["angles"].wanted == Text(zh="120° ± 3.5°", en="120° ± 3.5°")
    assert "105°" in items["angles"].partial.en
    assert "135°" in items["angles"].partial.zh
    assert items["closed"].wanted.en == "at most 4 %"
    assert items["moves"].wanted.zh == "至少 0.5 m"
    assert items["sides"].wanted.en == "3"
    assert items["rest"].wanted.zh == "是"


def test_published_rubric_says_what_counts_in_part_only() -> None:
    said = {each.id: each.needs.en for each in published_rubric(assignment("square")).items}
    assert "Needs half" in said["lengths"]
    straight = {each.id: each.needs.en for each in published_rubric(assignment("straight")).items}
    assert "Needs half" in straight["heading"]
    assert "Needs half" not in straight["distance"]  # commands are there, or not


def test_report_items_show_the_same_wanted_text() -> None:
    scoring = graded("square", drive(polygon_legs(4)))
    published = published_rubric(assignment("square"))
    assert [each.wanted for each in scoring.items] == [each.wanted for each in published.items]
    angles = item(scoring, "angles")
    assert (angles.target, angles.tolerance, angles.unit) == (90.0, 3.0, "deg")


def spec(measure: str) -> ItemSpec:
    return ItemSpec(id="x", title=Text(zh="项", en="item"), points=1.0, measure=measure, low=1.0)


@pytest.mark.parametrize(
    ("changes", "field", "word"),
    [
        ({"check": "polygone"}, "check", "polygon"),
        ({"options": {}}, "options.sides", "missing"),
        ({"options": {"sides": 2}}, "options.sides", "3 to 12"),
        ({"options": {"sides": True}}, "options.sides", "whole number"),
        ({"options": {"sides": 4, "colour": "red"}}, "options.colour", "remove"),
        ({"items": (spec("corners"),)}, "items.0.measure", "corner_deg"),
    ],
)
def test_what_does_not_fit_is_named(changes: dict[str, object], field: str, word: str) -> None:
    broken = replace(assignment("square"), **changes)  # type: ignore[arg-type]
    found = dict(problems(broken))
    assert word in found[field].en
    assert found[field].zh != found[field].en
    with pytest.raises(AssignmentError, match=field):
        evaluate(broken, [run_of(drive(polygon_legs(4)))])


def test_the_table_is_keyed_by_kind() -> None:
    assert all(kind == check.kind for kind, check in CHECKS.items())


@pytest.mark.parametrize(
    ("across", "earned", "words"), [("worst", 0, "Worst in b"), ("mean", 3, "30 % on average over 2 runs")]
)
def test_an_item_may_be_scored_by_the_worst_run_or_by_the_mean(
    across: str, earned: float, words: str
) -> None:
    square = assignment("square")
    gap = next(spec for spec in square.items if spec.measure == "side_spread_pct")
    band = replace(gap, across=across, points=10.0, needs=(), high=0.0, ramp=48.0, low=None)
    items = tuple(band if spec.id == gap.id else spec for spec in square.items)
    task = replace(square, items=items, cases=(Case(id="a"), Case(id="b")))
    runs = [
        replace(run_of(drive(polygon_legs(4, lengths_m=lengths))), case=case)
        for case, lengths in (("a", (2.0, 2.0, 2.0, 2.0)), ("b", (2.6, 1.4, 2.6, 1.4)))
    ]
    scoring = evaluate(task, runs)
    assert [each.id for each in scoring.items].count(gap.id) == 1
    last = scoring.items[-1]
    assert (last.id, last.points) == (gap.id, 10.0)
    assert words in last.message.en, last.message.en
    assert f"a/{items[0].id}" in [each.id for each in scoring.items]
    assert last.earned == pytest.approx(earned, abs=2.0)
    assert sum(each.points for each in scoring.items) == task.max_score
    published = next(each for each in published_rubric(task).items if each.id == gap.id)
    assert published.measure.en.endswith(("worst of the runs", "over the runs"))
