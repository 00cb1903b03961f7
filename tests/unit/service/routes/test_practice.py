"""Practice over HTTP: what it tells, what it keeps (nothing), and whom it lets wait."""

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from datetime import timedelta
from typing import Any

import httpx
import pytest
from sqlalchemy import create_engine, inspect, text

from grader.contracts.assignment import Assignment, Case
from grader.contracts.errors import InfrastructureError, SandboxUnavailableError
from grader.contracts.grading import GradingJob, GradingResult, RunProgress
from grader.grading.practice import PracticeRuns
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import FakeGrader, grade
from tests.fakes.waiting import PATIENCE_S, wait_until

Practise = Callable[..., httpx.Response]


class Recording(FakeGrader):
    """Keeps what it was asked to run; the report is of all of the assignment's items."""

    def __init__(self) -> None:
        super().__init__(self._noted)
        self.jobs: list[GradingJob] = []

    def _noted(self, job: GradingJob) -> GradingResult:
        self.jobs.append(job)
        return grade(job)


@pytest.fixture
def grader() -> Recording:
    return Recording()


@pytest.fixture
def busy() -> list[bool]:
    """Holds something while submissions wait."""
    return []


@pytest.fixture
def services(services: Services, grader: Recording, busy: list[bool]) -> Any:
    runs = PracticeRuns(1, lambda: grader, lambda: bool(busy), patience_s=0.0)
    yield replace(services, practice=runs)
    runs.close()


Follow = Callable[..., AbstractContextManager[Iterator[tuple[str, Any]]]]


@pytest.fixture
def follow(client: httpx.Client, school: Any) -> Follow:
    """Run a script and yield the events of the answer, each with its data."""

    @contextmanager
    def opened(source: bytes = b"good good\n", person: str = "li") -> Iterator[Iterator[tuple[str, Any]]]:
        with client.stream(
            "POST",
            "/api/v1/practice/events",
            files={"file": ("square.py", source)},
            data={"assignment": "square"},
            headers={**school.as_(person), "Accept-Language": "en"},
        ) as answer:
            assert answer.status_code == 200, answer.read()
            assert answer.headers["Content-Type"].startswith("text/event-stream")
            assert answer.headers["X-Accel-Buffering"] == "no"
            lines = answer.iter_lines()
            yield ((one[7:], json.loads(next(lines)[6:])) for one in lines if one.startswith("event: "))

    return opened


@pytest.fixture
def practise(client: httpx.Client, school: Any) -> Practise:
    def send(
        source: bytes = b"good good\n",
        person: str = "li",
        assignment: str = "square",
        name: str = "square.py",
    ) -> httpx.Response:
        return client.post(
            "/api/v1/practice",
            files={"file": (name, source)},
            data={"assignment": assignment},
            headers={**school.as_(person), "Accept-Language": "en"},
        )

    return send


def rows(url: str) -> dict[str, int]:
    """How many rows each table has, streams of requests apart."""
    engine = create_engine(url)
    with engine.connect() as connection:
        found = {
            table: connection.execute(text(f'SELECT count(*) FROM "{table}"')).scalar_one()
            for table in inspect(engine).get_table_names()
        }
    engine.dispose()
    return found


def test_it_tells_what_was_seen_and_keeps_nothing(practise: Practise, sqlite_url: str) -> None:
    before = rows(sqlite_url)
    answer = practise(b"good\n")
    assert answer.status_code == 200
    told = answer.json()
    assert [(one["id"], one["status"]) for one in told["items"]] == [
        ("sides", "passed"),
        ("closed", "failed"),
    ]
    assert not {"points", "earned"} & told["items"][0].keys()
    assert (told["hint"], told["mistakes"][0]) == ("go on", "interior_angle")
    assert told["runs"][0]["case"] == "default"
    assert told["trajectory"]["x_m"] == [5.5, 6.5]
    assert answer.headers["Cache-Control"] == "no-store"
    assert rows(sqlite_url) == before
    assert before["submission"] == 0


def test_hidden_items_are_not_told(
    practise: Practise, client: httpx.Client, school: Any, services: Services
) -> None:
    hidden = {"hidden_items": ["closed"], "hidden_until": "2099-01-01T00:00:00"}
    done = client.put("/api/v1/assignments/square/rules", json=hidden, headers=school.as_("wang"))
    assert done.status_code == 200, done.text
    told = practise(b"good\n").json()
    assert [one["id"] for one in told["items"]] == ["sides"]
    assert (told["hint"], told["mistakes"]) == ("", [])
    assert "closed" not in practise(b"good\n").text
    assert [one["id"] for one in practise(b"good\n", "ta").json()["items"]] == ["sides", "closed"]


@pytest.mark.parametrize("rules", [{"opens": "2099-01-01T00:00:00"}, {"shown": "draft"}])
def test_what_is_not_open_is_not_there(
    practise: Practise, client: httpx.Client, school: Any, rules: dict[str, str], grader: Recording
) -> None:
    done = client.put("/api/v1/assignments/square/rules", json=rules, headers=school.as_("wang"))
    assert done.status_code == 200, done.text
    for person, status in (("li", 404), ("wang", 200)):
        assert practise(person=person).status_code == status
    assert practise(assignment="none").json()["code"] == "assignment_not_found"
    assert len(grader.jobs) == 1


def test_only_the_first_case_is_run_with_other_noise(
    practise: Practise, services: Any, grader: Recording
) -> None:
    known: tuple[Assignment, ...] = services.assignments.assignments
    cases = (Case(id="car_1", seed=1), Case(id="car_2", seed=2))
    services.assignments.assignments = tuple(replace(one, cases=cases) for one in known)
    practise()
    (job,) = grader.jobs
    (case,) = job.assignment.cases
    assert case.id == "car_1"
    assert case.seed not in (1, 2)
    assert job.assignment.limits.cpu_s < known[0].limits.cpu_s


def test_texts_are_not_practised(practise: Practise, services: Any) -> None:
    known = services.assignments.assignments
    services.assignments.assignments = tuple(replace(one, input="text") for one in known)
    assert practise().json()["code"] == "practice_scripts_only"


@pytest.mark.parametrize(
    ("source", "name", "code"),
    [
        (b"", "a.py", "empty"),
        (b"\xff", "a.py", "not_utf8"),
        (b"x\n", "a.txt", "wrong_file_type"),
        (b"#" * 4096, "a.py", "too_large"),
    ],
)
def test_what_is_no_script_is_refused(practise: Practise, source: bytes, name: str, code: str) -> None:
    assert practise(source, name=name).json()["code"] == code


def test_a_person_has_one_run_under_way(practise: Practise, grader: Recording) -> None:
    grader.hold()
    first = threading.Thread(target=practise)
    first.start()
    assert grader.busy.wait(30)
    second = practise()
    assert (second.status_code, second.json()["code"]) == (429, "too_many_at_once")
    assert int(second.headers["Retry-After"]) >= 1
    grader.release()
    first.join()
    wait_until(lambda: practise().status_code == 200)


def test_a_person_has_some_runs_a_minute(practise: Practise, services: Services, clock: FakeClock) -> None:
    for _ in range(services.settings.practice_per_minute):
        assert practise().status_code == 200
    refused = practise()
    assert (refused.status_code, refused.json()["code"]) == (429, "too_many_requests")
    assert practise(person="han").status_code == 200
    clock.advance(int(refused.headers["Retry-After"]))
    assert practise().status_code == 200


def test_a_long_run_counts_as_several(
    practise: Practise, services: Services, grader: Recording, clock: FakeClock
) -> None:
    slow = grade(GradingJob(file_name="a.py", source=b"x", assignment=services.assignments.get("square")))
    grader._grading = lambda job: replace(slow, measurements=replace(slow.measurements, wall_s=9.5))
    answers = [practise().status_code for _ in range(3)]
    assert answers == [200, 200, 429]  # ten of twelve, then two and what is owed


def test_submissions_go_first(practise: Practise, busy: list[bool], grader: Recording) -> None:
    busy.append(True)
    refused = practise()
    assert (refused.status_code, refused.json()["code"]) == (503, "practice_waits")
    assert "Retry-After" in refused.headers
    assert not grader.jobs
    busy.clear()
    assert practise().status_code == 200


def test_a_queued_submission_waits_for_nobody(
    services: Services, upload: Callable[..., httpx.Response], school: Any, clock: FakeClock
) -> None:
    """What the composition gives to practice as `submissions_wait`."""
    assert not services.queue.is_due()
    upload(student="", headers=school.as_("li"))
    assert services.queue.is_due()
    assert services.queue.claim("w") is not None
    assert not services.queue.is_due()


def test_a_run_is_followed_to_its_end(follow: Follow, practise: Practise, grader: Recording) -> None:
    grader.hold()
    grader.progress.append(RunProgress(t_ns=1_500_000_000, stdout="a\n", stderr="b\n"))
    with follow() as first:
        assert grader.busy.wait(PATIENCE_S)
        running = next(told for told in first if told[0] == "running")
        assert running[1] == {"virtual_s": 1.5, "stdout": "a\n", "stderr": "b\n"}
        with follow(person="han") as second:
            assert next(second) == ("waiting", {"before": 1})
            grader.release()
            *_, (name, seen) = first
            assert name == "seen"
            assert [name for name, _ in second][-1] == "seen"
    assert seen == practise().json()


def test_events_tell_no_more_than_the_answer(
    follow: Follow, client: httpx.Client, school: Any, services: Services, sqlite_url: str
) -> None:
    hidden = {"hidden_items": ["closed"], "hidden_until": "2099-01-01T00:00:00"}
    client.put("/api/v1/assignments/square/rules", json=hidden, headers=school.as_("wang"))
    before = rows(sqlite_url)
    with follow() as events:
        told = list(events)
    assert "closed" not in json.dumps(told)
    assert [one["id"] for one in told[-1][1]["items"]] == ["sides"]
    assert rows(sqlite_url) == before


def test_who_goes_away_gives_up_the_place(follow: Follow, grader: Recording, practise: Practise) -> None:
    grader.hold()
    with follow(b"first\n"):
        assert grader.busy.wait(PATIENCE_S)
        with follow(b"second\n", "han") as gone:
            assert next(gone)[0] == "waiting"
            assert practise(person="han").json()["code"] == "too_many_at_once"
        with follow(b"third\n", "ta") as waiting:
            next(told for told in waiting if told == ("waiting", {"before": 1}))
            grader.release()
            assert list(waiting)[-1][0] == "seen"
    assert [one.source for one in grader.jobs] == [b"first\n", b"third\n"]
    assert practise(person="han").status_code == 200


def test_who_goes_away_from_a_run_has_it_still(
    follow: Follow, grader: Recording, practise: Practise, services: Services
) -> None:
    """Else anybody could have as many as there are places."""
    slow = grade(GradingJob(file_name="a.py", source=b"x", assignment=services.assignments.get("square")))
    grader._grading = lambda job: replace(slow, measurements=replace(slow.measurements, wall_s=99.0))
    grader.hold()
    with follow():
        assert grader.busy.wait(PATIENCE_S)
    assert practise().json()["code"] == "too_many_at_once"
    grader.release()
    wait_until(lambda: practise().json()["code"] == "too_many_requests")  # it was charged, too


def test_who_follows_has_a_request_under_way(
    follow: Follow, grader: Recording, client: httpx.Client, school: Any, services: Services
) -> None:
    """So nobody collects answers that they do not read."""
    services.allowances.requests_at_once._most = 1
    grader.hold()
    with follow() as events:
        next(events)
        assert (
            client.get("/api/v1/assignments", headers=school.as_("li")).json()["code"] == "too_many_at_once"
        )
        grader.release()
        assert list(events)[-1][0] == "seen"
    wait_until(lambda: client.get("/api/v1/assignments", headers=school.as_("li")).status_code == 200)


@pytest.mark.parametrize(
    ("fault", "code"),
    [
        (SandboxUnavailableError("no user namespaces"), "practice_off"),
        (InfrastructureError("the process was killed"), "unavailable"),
        (None, "practice_waits"),
    ],
)
def test_what_goes_wrong_meanwhile_is_the_last_event(
    follow: Follow, grader: Recording, busy: list[bool], fault: Exception | None, code: str
) -> None:
    if fault is None:
        busy.append(True)
    else:
        grader.faults.append(fault)
    with follow() as events:
        *_, (name, problem) = events
    assert (name, problem["code"], problem["status"]) == ("refused", code, 503)
    assert "killed" not in json.dumps(problem)
    assert problem["fix"]


def test_without_a_sandbox_it_is_off(practise: Practise, grader: Recording) -> None:
    grader.faults.append(SandboxUnavailableError("no user namespaces"))
    refused = practise()
    assert (refused.status_code, refused.json()["code"]) == (503, "practice_off")


def test_opening_is_by_the_course_clock(
    practise: Practise, client: httpx.Client, school: Any, clock: FakeClock
) -> None:
    opens = (START + timedelta(seconds=60)).isoformat()
    client.put("/api/v1/assignments/square/rules", json={"opens": opens}, headers=school.as_("wang"))
    assert practise().status_code == 404
    clock.advance(61)
    assert practise().status_code == 200
