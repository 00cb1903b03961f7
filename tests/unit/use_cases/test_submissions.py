"""Handing in and reading through a door of its own: no HTTP, so the use cases alone decide who may do what."""

from collections.abc import Iterator

import pytest

from grader.contracts.errors import InfrastructureError, RefusedError
from grader.contracts.identity import Caller, Role, RosterEntry
from grader.contracts.rules import Rules
from grader.contracts.submission import Submission, SubmissionState
from grader.store.audit import Signature
from grader.use_cases import recordings, submissions
from grader.use_cases.assignments import terms_of
from grader.use_cases.handing_in import Upload, hand_in
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.grading import grade_next

LI = Caller(course="ros", person="li", role=Role.STUDENT)
HAN = Caller(course="ros", person="han", role=Role.STUDENT)
WANG = Caller(course="ros", person="wang", role=Role.INSTRUCTOR)
ELSEWHERE = Caller(course="other", person="zhao", role=Role.INSTRUCTOR)


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock()


@pytest.fixture
def services(sqlite_url: str, clock: FakeClock) -> Iterator[Services]:
    with server.services(server.settings(database_url=sqlite_url, uploads_per_minute=4), clock) as made:
        people = [RosterEntry(id=one, name=one, role=Role.STUDENT) for one in ("li", "han")]
        for course in ("ros", "other"):
            made.courses.create(course, course, "UTC", "test")
            made.courses.import_roster(course, people, "test")
        yield made


def handed_in(
    services: Services, caller: Caller, content: bytes = b"good\n", student: str = ""
) -> Submission:
    upload = Upload(
        assignment="square",
        student=student,
        file_name="square.py",
        content=content,
        arrived_at=services.clock(),
    )
    return hand_in(services, caller, upload)[0]


def refused(call: object, *args: object) -> str:
    assert callable(call)
    with pytest.raises(RefusedError) as error:
        call(*args)
    return error.value.code


def test_students_hand_in_for_themselves_and_instructors_for_anybody_in_the_course(
    services: Services,
) -> None:
    assert handed_in(services, LI).student == "li"
    assert handed_in(services, WANG, b"other\n", "han").student == "han"
    assert refused(handed_in, services, LI, b"x\n", "han") == "forbidden"
    assert refused(handed_in, services, WANG, b"x\n", "nobody") == "unknown_student"


def test_only_students_are_bound_by_the_rules(services: Services) -> None:
    services.rules.set("square", Rules(attempts=1), Signature(services.clock(), "ros", "wang"))
    handed_in(services, LI)
    assert refused(handed_in, services, LI, b"again\n") == "no_attempts_left"
    assert handed_in(services, WANG, b"again\n", "li").student == "li"
    assert terms_of(services, LI, "square").refusal is not None
    assert terms_of(services, HAN, "square").refusal is None


def test_a_limit_of_uploads_says_when_to_come_back(services: Services) -> None:
    for number in range(4):
        handed_in(services, LI, b"good %d\n" % number)
    with pytest.raises(RefusedError) as error:
        handed_in(services, LI, b"one more\n")
    assert (error.value.code, error.value.retry_after_s) == ("too_many_requests", 15)


def test_what_keeps_a_check_busy_counts_as_several_and_a_fault_of_ours_as_one(services: Services) -> None:
    services.preflight.busy_s = 0.5
    handed_in(services, LI)
    handed_in(services, LI, b"again\n")
    assert refused(handed_in, services, LI, b"once more\n") == "too_many_requests"
    services.preflight.fault = InfrastructureError("it did not answer")
    for number in range(4):
        handed_in(services, HAN, b"good %d\n" % number)


def test_uploads_that_are_slow_to_check_count_as_several(services: Services) -> None:
    services.allowances.uploads.take("ros/li")
    services.allowances.uploads.charge("ros/li", 100)
    with pytest.raises(RefusedError) as error:
        handed_in(services, LI, b"good\n")
    assert error.value.retry_after_s == 75  # all of a minute's four, and one more
    assert handed_in(services, HAN, b"good\n").student == "han"


def test_a_student_hands_in_few_files_at_once(services: Services) -> None:
    with (
        services.allowances.uploads_at_once.one_more("ros/li"),
        services.allowances.uploads_at_once.one_more("ros/li"),
    ):
        assert refused(handed_in, services, LI, b"good\n") == "too_many_at_once"
        assert handed_in(services, HAN, b"good\n").student == "han"
    assert handed_in(services, LI, b"good\n").student == "li"


@pytest.mark.parametrize("stranger", [HAN, ELSEWHERE])
def test_whatever_reads_a_submission_refuses_strangers_as_if_there_were_none(
    services: Services, stranger: Caller
) -> None:
    id_ = handed_in(services, LI).id
    assert grade_next(services.queue, services.assignments)
    for read in (submissions.read, submissions.read_source, graded):
        assert refused(read, services, stranger, id_) == "submission_not_found"
        assert refused(read, services, stranger, "no-such") == "submission_not_found"
    assert refused(recordings.trajectory, services, stranger, id_, None) == "submission_not_found"
    assert refused(submissions.attempts, services, HAN, "li") == "forbidden"
    assert [one.id for one in submissions.attempts(services, WANG, "li")] == [id_]
    assert submissions.read(services, LI, id_).submission.state is SubmissionState.GRADED
    assert submissions.read_source(services, WANG, id_)[1] == b"good\n"


def test_a_waiting_submission_has_a_place_and_no_grading(services: Services, clock: FakeClock) -> None:
    first = handed_in(services, LI)
    clock.advance(1)
    second = handed_in(services, HAN)
    assert [submissions.read(services, WANG, one.id).position for one in (first, second)] == [0, 1]
    with pytest.raises(RefusedError) as error:
        graded(services, LI, first.id)
    assert error.value.code == "not_graded_yet"
    assert error.value.detail is not None
