"""Right as driven, or right as commanded: the better of the two counts, as a whole."""

from dataclasses import replace

import pytest

from grader.checks import evaluate, mark, sketch
from grader.checks.remarks import notes_of_both
from grader.contracts.assignment import Counts
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Scoring
from grader.contracts.trajectory import Trajectory, decode_trajectory, encode_trajectory, recorded
from tests.unit.checks.shipped import assignment, score
from tests.unit.checks.trajectories import drive, polygon_legs, run_of

RIGHT = drive(polygon_legs(4))
WIDE = drive(polygon_legs(4, corners_deg=[95.3] * 4))


def both(driven: Trajectory, commanded: Trajectory) -> Trajectory:
    return replace(driven, commanded=replace(commanded, commands=driven.commands))


def scored(trajectory: Trajectory, counts: Counts = "either") -> Scoring:
    task = replace(assignment("square"), counts=counts)
    return evaluate(task, [run_of(trajectory, RunStatus.FINISHED)])


@pytest.mark.parametrize(("driven", "commanded"), [(RIGHT, WIDE), (WIDE, RIGHT)])
def test_what_is_right_either_way_is_right(driven: Trajectory, commanded: Trajectory) -> None:
    assert score(scored(both(driven, commanded))) == 100.0


def test_what_is_wrong_both_ways_gains_nothing() -> None:
    wide, wider = (drive(polygon_legs(4, corners_deg=[corner] * 4)) for corner in (100.0, 101.0))
    for driven, commanded in ((wide, wider), (wider, wide)):
        assert scored(both(driven, commanded)) == scored(commanded)


def test_what_was_nearly_right_at_home_counts() -> None:
    nearly = drive([*polygon_legs(4, corners_deg=[93.5, 90.0, 90.0, 90.0])])
    assert 90.0 < score(scored(nearly)) < 100.0
    assert scored(both(nearly, drive(polygon_legs(4, corners_deg=[75.0] * 4)))) == scored(nearly)


def test_driven_counts_alone_where_the_assignment_says_so() -> None:
    assert scored(both(WIDE, RIGHT), "driven") == scored(WIDE)
    assert scored(both(RIGHT, WIDE), "driven") == scored(RIGHT)


def test_one_choice_is_made_for_all_runs() -> None:
    task = assignment("square_input")
    first, second = (run_of(both(*paths), RunStatus.FINISHED) for paths in ((RIGHT, WIDE), (WIDE, RIGHT)))
    runs = [replace(first, case=task.cases[0].id), replace(second, case=task.cases[-1].id)]
    assert {run.trajectory.heading_rad[-1] for run in mark(task, runs).runs} == {
        run.trajectory.heading_rad[-1] for run in runs
    }


def test_notes_say_which_counts_and_what_the_corners_are_at_home() -> None:
    counted, corners = notes_of_both(run_of(both(WIDE, RIGHT), RunStatus.FINISHED), as_commanded=True)
    assert (counted.code, counted.text) == ("counted_commanded", "8 m|381.2°|8 m|360°")
    assert (corners.code, corners.text) == ("corners_at_home", "95.3°|90°")
    counted, _ = notes_of_both(run_of(both(RIGHT, WIDE), RunStatus.FINISHED), as_commanded=False)
    assert counted.code == "counted_driven"


def test_corners_that_are_alike_or_have_no_partners_are_not_told() -> None:
    three = drive(polygon_legs(4)[:-2])
    for commanded in (RIGHT, three, drive([(2.0, 1.0, 0.0)])):
        notes = notes_of_both(run_of(both(RIGHT, commanded), RunStatus.FINISHED), as_commanded=False)
        assert [note.code for note in notes] == ["counted_driven"]


def test_a_sketch_has_both_paths() -> None:
    run = run_of(both(WIDE, RIGHT), RunStatus.FINISHED)
    drawn = sketch(assignment("square"), run)
    assert drawn.commanded_m[0] == (5.544, 5.544)
    assert drawn.commanded_m[-1] == pytest.approx((5.544, 5.544), abs=0.01)
    assert not sketch(assignment("square"), run_of(RIGHT, RunStatus.FINISHED)).commanded_m


def test_both_motions_are_stored() -> None:
    stored = decode_trajectory(encode_trajectory(recorded(both(WIDE, RIGHT))))
    assert stored.commanded is not None
    assert stored.commanded.x_m.tolist() == RIGHT.x_m.round(6).tolist()
    assert stored.at_once().commands == stored.commands
    assert decode_trajectory(encode_trajectory(recorded(RIGHT))).commanded is None
