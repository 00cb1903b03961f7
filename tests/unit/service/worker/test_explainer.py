"""The thread that explains: behind everybody, and without any effect on marks."""

from collections.abc import Iterator

import pytest

from grader.contracts.errors import InfrastructureError
from grader.contracts.explanation import Explanation
from grader.contracts.submission import SubmissionState
from grader.service.worker.explainer import Explainer, Explaining
from grader.store.explanations import Explanations
from grader.store.rules import StoredRules
from tests.fakes.grading import FakeGrader
from tests.fakes.worker_bench import Bench

FOUND = Explanation(tried=4)


class Desk:
    """A bench with an explainer whose grader finds `FOUND`."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.grader = FakeGrader()
        self.grader.explanation = FOUND
        self.explanations = Explanations(bench.database, bench.clock)
        self.explainer = Explainer(
            Explaining(
                explanations=self.explanations,
                rules=StoredRules(bench.database),
                make_grader=lambda: self.grader,
                clock=bench.clock,
            ),
            bench.doorbell,
            ready=lambda: True,
            submissions_wait=bench.queue.is_due,
        )

    def graded(self, source: bytes = b"good") -> str:
        id_ = self.bench.upload(source)
        assert self.bench.slot().step()
        return id_


@pytest.fixture
def desk(sqlite_url: str) -> Iterator[Desk]:
    bench = Bench(sqlite_url)
    yield Desk(bench)
    bench.database.close()


def test_it_explains_what_was_graded(desk: Desk) -> None:
    id_ = desk.graded()
    assert desk.explainer.step()
    assert desk.explanations.of(id_, 1) == FOUND
    assert not desk.explainer.step()


def test_it_begins_nothing_while_a_submission_waits(desk: Desk) -> None:
    id_ = desk.graded()
    desk.bench.upload(b"good  # of somebody else", student="s2")
    assert not desk.explainer.step()
    assert desk.grader.explained == []
    assert desk.bench.slot().step()
    assert desk.explainer.step()
    assert desk.explainer.step()
    assert desk.explanations.of(id_, 1) == FOUND


def test_a_submission_that_comes_meanwhile_goes_first(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    desk.graded()
    waits = [False, True, True, False]  # before the claim, then before the first trial
    looks: list[bool] = []

    def submissions_wait() -> bool:
        looks.append(waits[len(looks)])
        return looks[-1]

    monkeypatch.setattr(desk.explainer, "_submissions_wait", submissions_wait)
    assert desk.explainer.step()
    assert looks == waits


def test_a_search_that_fails_is_tried_once_more_and_leaves_the_marks(desk: Desk) -> None:
    id_ = desk.graded()
    before = desk.bench.submissions.report(id_)
    desk.grader.faults = [InfrastructureError("it died"), ValueError("astray")]
    assert desk.explainer.step()
    assert desk.explanations.of(id_, 1) is None
    assert desk.explainer.step()
    assert desk.explanations.of(id_, 1) == Explanation()
    assert not desk.explainer.step()
    assert desk.bench.submissions.report(id_) == before
    assert desk.bench.row(id_).state is SubmissionState.GRADED


def test_one_that_ended_its_workers_is_not_tried_for_ever(desk: Desk) -> None:
    id_ = desk.graded()
    for _ in range(2):
        assert desk.explanations.claim() is not None
        desk.bench.clock.advance(1_000.0)
    assert desk.explainer.step()
    assert desk.grader.explained == []
    assert desk.explanations.of(id_, 1) == Explanation()


def test_a_worker_that_stops_leaves_it_to_others(desk: Desk) -> None:
    id_ = desk.graded()
    desk.explainer._stopping.set()
    assert desk.explainer.step()
    assert desk.explanations.of(id_, 1) is None
    claim = desk.explanations.claim()
    assert claim is not None
    assert claim.tries == 1
