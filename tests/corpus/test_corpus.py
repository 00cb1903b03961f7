"""No right script loses more than a tenth, no wrong one gets full marks; defects cost from 8 % and 6° on."""

from collections import Counter

import pytest

from grader.contracts.grading import Grader
from tests.corpus.attempts import FIGURES, HORIZON_S, STYLES, Attempt, corpus
from tests.corpus.scoring import READY_S, confusion, for_real, on_the_ideal_turtle
from tests.rows import slow_but

CORPUS = corpus()


def kinds(attempt: Attempt) -> set[tuple[object, ...]]:
    """What an attempt stands for when it is graded for real."""
    return {
        ("style", attempt.style, attempt.truth),
        ("style", attempt.style, attempt.for_ever),
        ("assignment", attempt.assignment, attempt.truth),
        ("defect", attempt.defect),
    }


def sample() -> list[Attempt]:
    """Choose attempts to go through sandbox, shim and simulator as well: few, of every kind there is."""
    wanted = set().union(*map(kinds, CORPUS))
    chosen: list[Attempt] = []
    while wanted:
        chosen.append(max(CORPUS, key=lambda attempt: len(kinds(attempt) & wanted)))
        wanted -= kinds(chosen[-1])
    return chosen


def test_the_corpus_is_large_and_varied() -> None:
    truths = Counter(attempt.truth for attempt in CORPUS)
    assert truths["right"] >= 300
    assert truths["wrong"] >= 300
    assert {attempt.style for attempt in CORPUS} == set(STYLES)
    assert {attempt.assignment for attempt in CORPUS} >= set(FIGURES)


@pytest.mark.parametrize("name", slow_but(3, [*FIGURES, "straight", "backward", "spin"]))
def test_nothing_is_scored_wrongly_on_the_ideal_turtle(name: str) -> None:
    scored = [on_the_ideal_turtle(attempt) for attempt in CORPUS if attempt.assignment == name]
    assert len(scored) > 20
    assert not [str(each) for each in scored if each.scored_wrongly], confusion(scored)


@pytest.mark.parametrize("attempt", slow_but(10, sample()), ids=str)
def test_nothing_is_scored_wrongly_for_real(grader: Grader, attempt: Attempt) -> None:
    scored = for_real(grader)(attempt)
    assert not scored.scored_wrongly, str(scored)


def test_an_endless_figure_scores_the_same_wherever_ctrl_c_ends_it() -> None:
    """Each sixth endless script begins at six phases of its lap; a lap is complete at the horizon."""
    endless = [attempt for attempt in CORPUS if attempt.for_ever][::6]
    assert len(endless) > 10
    for attempt in endless:
        phases_s = [READY_S + i * attempt.duration_s / 6.0 for i in range(6)]
        fitting = [ready_s for ready_s in phases_s if ready_s + 1.05 * attempt.duration_s < HORIZON_S]
        assert {on_the_ideal_turtle(attempt, ready_s).score for ready_s in fitting} == {100.0}, str(attempt)
