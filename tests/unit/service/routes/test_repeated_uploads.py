"""Uploads that are sent again, and when a submission will be graded."""

from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta

import httpx

from grader.contracts.grading import GradingJob
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import assignment, grade
from tests.unit.service.routes.conftest import School
from tests.unit.service.routes.test_overviews import worker

Upload = Callable[..., httpx.Response]


def key(text: str) -> dict[str, str]:
    return {"Idempotency-Key": text}


def test_an_upload_sent_again_is_stored_once(upload: Upload, services: Services) -> None:
    first = upload(b"good\n", headers=key("abc")).json()
    upload(b"x = 1\n")
    again = upload(b"good\n", headers=key("abc")).json()
    assert again == {**first, "repeated": True}
    assert services.queue.state().queued == 2


def test_a_key_belongs_to_one_upload_of_one_student(upload: Upload) -> None:
    first = upload(b"good\n", headers=key("abc")).json()
    for changed in ({"source": b"bad\n"}, {"assignment": "straight"}, {"name": "other.py"}):
        response = upload(**{"source": b"good\n", **changed}, headers=key("abc"))
        assert (response.status_code, response.json()["code"]) == (422, "key_reused")
    assert upload(b"good\n", student="s2", headers=key("abc")).json()["id"] != first["id"]


def test_keys_are_forgotten(upload: Upload, clock: FakeClock) -> None:
    upload(b"good\n", headers=key("abc"))
    clock.advance(8 * 86_400)
    assert upload(b"bad\n", headers=key("abc")).status_code == 202


def test_the_same_bytes_again_are_recognised(upload: Upload, graded: Callable[..., str]) -> None:
    url = graded(b"good\n")
    again = upload(b"good\n")
    assert (again.status_code, again.headers["Location"], again.json()["repeated"]) == (202, url, True)
    assert upload(b"good\n", student="s2").json()["repeated"] is False
    assert upload(b"good\n", assignment="straight").json()["repeated"] is False


def test_going_back_to_earlier_bytes_is_a_new_submission(upload: Upload, clock: FakeClock) -> None:
    first = upload(b"good\n").json()
    clock.advance(1)
    upload(b"bad\n")
    back = upload(b"good\n").json()
    assert (back["repeated"], back["id"] == first["id"]) == (False, False)


def test_a_changed_assignment_grades_the_same_bytes_again(
    upload: Upload, graded: Callable[..., str], services: Services
) -> None:
    graded(b"good\n")
    services.assignments.assignments = tuple(
        replace(one, version=one.version + 1) for one in services.assignments.assignments
    )
    assert upload(b"good\n").json()["repeated"] is False


def test_another_release_of_the_course_grades_the_same_bytes_again(
    upload: Upload, graded: Callable[..., str], services: Services, school: School, clock: FakeClock
) -> None:
    own, (straight, square) = school.as_("li"), services.assignments.assignments
    services.assignments.assignments = (replace(straight, distro="humble"), square)
    for one in ("straight", "square"):
        graded(b"good\n", one, "", headers=own)
    services.courses.change(Signature(clock(), "ros", "wang"), distro="jazzy")
    clock.advance(1)
    assert upload(b"good\n", "straight", "", headers=own).json()["repeated"] is True
    again = graded(b"good\n", student="", headers=own)
    assert upload(b"good\n", student="", headers=own).headers["Location"] == again
    assert len(services.submissions.of_student("li", "square", "ros")) == 2


def test_after_a_fault_of_the_service_the_same_bytes_are_graded(upload: Upload, services: Services) -> None:
    upload(b"good\n")
    for _ in range(3):
        services.queue.fail(services.queue.claim("w"), "no")
    assert upload(b"good\n").json()["repeated"] is False


def test_nobody_guesses_without_measurements(upload: Upload, client: httpx.Client) -> None:
    assert client.get(upload().headers["Location"]).json()["estimated_finish_at"] is None


def test_an_estimate_comes_from_what_was_measured(
    upload: Upload, client: httpx.Client, services: Services, clock: FakeClock
) -> None:
    upload(student="first")
    claim = services.queue.claim("w")
    clock.advance(4)
    services.queue.finish(
        claim,
        grade(GradingJob(file_name="a.py", source=claim.source, assignment=assignment())),
        assignment(),
    )
    services.workers.report(worker(clock))  # two slots
    urls = []
    for student in "abc":
        urls.append(upload(student=student).headers["Location"])
        clock.advance(0.001)
    guesses = [client.get(url).json()["estimated_finish_at"] for url in urls]
    now = START + timedelta(seconds=4.003)
    expected = [now + timedelta(seconds=seconds) for seconds in (4, 4, 8)]
    assert guesses == [one.isoformat().replace("+00:00", "Z") for one in expected]
