"""Which scripts of a class are compared, what counts as given, and who may ask."""

import asyncio
import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from grader.catalog import Catalog
from grader.contracts.errors import RefusedError
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.identity import Caller, Role, RosterEntry
from grader.contracts.submission import NewSubmission
from grader.use_cases.comparing import Similar
from grader.use_cases.services import Services
from grader.use_cases.similar import side_by_side, similar
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.grading import assignment, grade, grade_next, trajectory
from tests.unit.similarity.students import SQUARE, changed_square, renamed

WANG = Caller(course="ros", person="wang", role=Role.INSTRUCTOR)
LI = Caller(course="ros", person="s0", role=Role.STUDENT)
ELSEWHERE = Caller(course="other", person="zhao", role=Role.INSTRUCTOR)
SIDES = [[i * 16_000_000, float(i % 2), float(1 - i % 2)] for i in range(8)]


@pytest.fixture
def services(sqlite_url: str) -> Iterator[Services]:
    with server.services(server.settings(database_url=sqlite_url), FakeClock()) as made:
        people = [RosterEntry(id=f"s{i}", name="", role=Role.STUDENT) for i in range(8)]
        made.courses.create("ros", "ros", "UTC", "test")
        made.courses.import_roster(
            "ros", [RosterEntry(id="wang", name="", role=Role.INSTRUCTOR), *people], "test"
        )
        made.assignments.given_code = Catalog().given_code  # of the fakes nobody was given anything
        yield made


def driving(commands: list[list[float]]) -> Callable[[GradingJob], GradingResult]:
    """A grader that records these commands."""

    def graded(job: GradingJob) -> GradingResult:
        result, recorded = grade(job), json.loads(trajectory())
        recorded["commands"] = recorded.pop("commands") and commands
        content = json.dumps(recorded, separators=(",", ":")).encode()
        run = replace(result.report.runs[0], trajectory_sha256=hashlib.sha256(content).hexdigest())
        return replace(result, report=replace(result.report, runs=(run,)), trajectories={run.case: content})

    return graded


def put(
    services: Services,
    student: str,
    source: str,
    grading: Callable[[GradingJob], GradingResult] | None = grade,
    assignment: str = "square",
) -> str:
    new = NewSubmission(
        course="ros", student=student, assignment=assignment, file_name="a.py", source=source.encode()
    )
    added = services.intake.accept(new, services.clock())[0]
    if grading is not None:
        assert grade_next(services.queue, services.assignments, grading)
    services.clock.advance(60.0)  # type: ignore[attr-defined]
    return added.id


def found(services: Services, caller: Caller = WANG, assignment_id: str = "square") -> Similar:
    return asyncio.run(similar(services, caller, assignment_id))


def test_of_each_student_the_script_that_counts_is_compared(services: Services) -> None:
    put(services, "s0", changed_square(1) + "# good\n")
    put(services, "s0", changed_square(2))  # worth less: does not count
    put(services, "s1", renamed(changed_square(1)), grading=None)  # none is graded yet
    put(services, "s2", renamed(changed_square(2)))
    put(services, "s3", SQUARE)
    put(services, "s4", changed_square(1), assignment="straight")
    result = found(services)
    assert [(one.first.student, one.second.student) for one in result.pairs] == [("s0", "s1")]
    assert (result.compared, result.not_compared, result.too_little) == (3, 0, ("s3",))


def test_what_staff_handed_in_is_given_to_all(services: Services) -> None:
    for student in ("s0", "s1"):
        put(services, student, renamed(changed_square(5)))
    assert len(found(services).pairs) == 1
    put(services, "wang", changed_square(5))
    assert found(services).pairs == ()


def test_equal_drives_are_told_unless_the_given_code_drives_so(services: Services) -> None:
    put(services, "s0", changed_square(1), driving(SIDES))
    put(services, "s1", changed_square(2), driving(SIDES))
    put(services, "s2", changed_square(3), driving(SIDES[:-1]))
    ids = [(one.first.student, one.second.student) for one in found(services).same_drives]
    assert ids == [("s0", "s1")]
    put(services, "wang", SQUARE, driving(SIDES))
    assert found(services).same_drives == ()


def test_nothing_is_compared_twice(services: Services, monkeypatch: pytest.MonkeyPatch) -> None:
    put(services, "s0", changed_square(1))
    put(services, "s1", renamed(changed_square(1)))
    first = found(services)
    monkeypatch.setattr("grader.use_cases.similar.fingerprints", None)  # would fail if it were called
    assert found(services) is first
    put(services, "s2", changed_square(1))  # a file that is known
    assert len(found(services).pairs) == 3


def test_of_a_very_large_class_the_latest_are_compared(
    services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("grader.use_cases.similar.MOST_SCRIPTS", 2)
    for student in ("s0", "s2", "s1"):
        put(services, student, changed_square(1))
    result = found(services)
    assert (result.compared, result.not_compared) == (2, 1)
    assert {result.pairs[0].first.student, result.pairs[0].second.student} == {"s1", "s2"}


def test_two_scripts_side_by_side(services: Services) -> None:
    first, second = put(services, "s0", changed_square(1)), put(services, "s1", renamed(changed_square(1)))
    other = put(services, "s2", changed_square(2))
    for one, two in ((first, second), (second, first)):
        shown = asyncio.run(side_by_side(services, WANG, "square", one, two))
        assert shown.first_source.decode() == changed_square(1)
        assert shown.pair.second.student == "s1"
        assert shown.pair.found.places
    for pair in ((first, other), (first, first), ("none", second)):
        assert refused(side_by_side(services, WANG, "square", *pair)) == "submission_not_found"


def test_only_staff_asks_and_only_about_scripts_of_the_own_class(services: Services) -> None:
    put(services, "s0", changed_square(1))
    assert refused(similar(services, LI, "square")) == "forbidden"
    assert refused(side_by_side(services, LI, "square", "a", "b")) == "forbidden"
    assert refused(similar(services, WANG, "none")) == "assignment_not_found"
    services.courses.create("other", "other", "UTC", "test")
    assert found(services, ELSEWHERE).compared == 0
    services.assignments.assignments = (replace(assignment("essay"), input="text"),)  # type: ignore[attr-defined]
    assert refused(similar(services, WANG, "essay")) == "no_scripts"
    assert found(services).compared == 1  # no longer published, but handed in


def refused(asked: object) -> str:
    with pytest.raises(RefusedError) as error:
        asyncio.run(asked)  # type: ignore[arg-type]
    return error.value.code
