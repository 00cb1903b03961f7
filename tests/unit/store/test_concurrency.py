"""Threads that do the same at the same moment. SQLite lets writers in one by one; PostgreSQL does not."""

import threading
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import timedelta
from typing import TypeVar

import pytest
from sqlalchemy import text

from grader.contracts.appeal import AppealState
from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.grading import GradingJob
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.notice import Draft, NewWebhook, NoticeKind, Outlet, Vendor
from grader.contracts.platform import PlatformLink
from grader.contracts.regrade import RegradeState, Wanted
from grader.contracts.rules import Rules
from grader.contracts.submission import Claim, NewSubmission, Submission, SubmissionState
from grader.store.appeals import Appeals, Asked
from grader.store.audit import AuditLog, Signature
from grader.store.course_life import CourseLife
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.identities import Identities
from grader.store.intake import take_in
from grader.store.judgements import Given, Judgements
from grader.store.notices import Notices
from grader.store.own_assignments import NewOwnAssignment, OwnAssignments
from grader.store.platform_scores import PlatformScores
from grader.store.platforms import Platforms
from grader.store.queue import Queue, Retries
from grader.store.regrades import Regrades
from grader.store.rules import StoredRules
from grader.store.teams import Teams
from tests.fakes.clock import FakeClock
from tests.fakes.grading import assignment, grade
from tests.fakes.platforms import new_platform
from tests.fakes.submissions import Submissions

THREADS = 8
Done = TypeVar("Done")


def at_once(act: Callable[[int], Done]) -> list[Done | Exception]:
    """Call `act` in several threads at the same moment; return what came of each, errors among it."""
    start = threading.Barrier(THREADS)

    def one(number: int) -> Done | Exception:
        start.wait()
        try:
            return act(number)
        except Exception as error:
            return error

    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(one, range(THREADS)))


def count(database: Database, table: str) -> int:
    with database.reading() as session:
        return int(session.execute(text(f"SELECT count(*) FROM {table}")).scalar_one())


def new(student: str = "li", source: bytes = b"good", **more: object) -> NewSubmission:
    values: dict[str, object] = {"student": student, "assignment": "square", "file_name": "a.py"}
    return NewSubmission(**{**values, "source": source, **more})


def result_of(claim: Claim):
    return grade(GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment()))


@pytest.fixture
def course(database: Database, clock: FakeClock) -> str:
    return open_course(database, clock)


def open_course(database: Database, clock: FakeClock) -> str:
    courses = Courses(database, clock)
    courses.create("ros", "ROS", "UTC", "me")
    courses.import_roster("ros", [RosterEntry(id="li", name="李", role=Role.STUDENT)], "me")
    return "ros"


def test_a_limit_of_attempts_is_never_exceeded(
    database: Database, clock: FakeClock, submissions: Submissions, course: str
) -> None:
    StoredRules(database).set("square", Rules(attempts=3), Signature(clock(), course, "wang"))
    made = at_once(lambda n: submissions.add(new(source=b"good # %d" % n, course=course, ruled=True)))
    kinds = Counter(type(one) for one in made)
    assert kinds[RefusedError] == THREADS - 3
    assert count(database, "submission") == 3


def test_an_upload_sent_many_times_at_once_is_stored_once(
    database: Database, submissions: Submissions
) -> None:
    made = at_once(lambda _: submissions.accept(new(key="k")))
    assert sum(not repeated for _, repeated in made) == 1
    assert len({submission.id for submission, _ in made}) == 1
    assert (count(database, "submission"), count(database, "upload_key")) == (1, 1)


def test_the_same_bytes_from_many_students_are_kept_once(
    database: Database, submissions: Submissions
) -> None:
    made = at_once(lambda number: submissions.add(new(f"s{number}", b"the same")))
    assert len({submission.id for submission in made}) == THREADS
    assert (count(database, "submission"), count(database, "source")) == (THREADS, 1)


def test_turns_of_simultaneous_uploads_are_all_different(
    database: Database, submissions: Submissions
) -> None:
    at_once(lambda number: submissions.add(new(source=b"good # %d" % number)))
    with database.reading() as session:
        turns = session.execute(text("SELECT count(DISTINCT turn_at) FROM submission")).scalar_one()
    assert turns == THREADS


def test_claims_and_uploads_in_each_others_way(
    database: Database, queue: Queue, submissions: Submissions
) -> None:
    """Each student hands in again while slots take what waits: nothing is taken twice or left."""

    def hand_in_or_claim(number: int) -> list[str]:
        if number % 2:
            for version in range(4):
                submissions.add(new(f"s{number % 4}", b"good # %d %d" % (number, version)))
            return []
        taken = (queue.claim(f"w{number}") for _ in range(4))
        return [claim.submission_id for claim in taken if claim is not None]

    taken = [id_ for ids in at_once(hand_in_or_claim) for id_ in ids]
    while (claim := queue.claim("rest")) is not None:
        taken.append(claim.submission_id)
    assert max(Counter(taken).values()) == 1
    assert len(taken) == count(database, "submission") == 16


def test_a_sweep_waits_for_nobody(postgres_database: Database, clock: FakeClock) -> None:
    """It changes rows in no order; an upload, which holds some in order, could wait for it in turn."""
    queue = Queue(postgres_database, clock, Retries())
    submissions = Submissions(postgres_database, clock)
    held, free = (submissions.add(new(student)).id for student in ("li", "wang"))
    clock.advance(-3_600)
    with postgres_database.writing() as session:
        session.execute(text(f"SELECT FROM submission WHERE id = '{held}' FOR UPDATE"))
        queue.bring_forward()
        assert queue.claim("w").submission_id == free
        assert queue.claim("w") is None
    queue.bring_forward()
    assert queue.claim("w").submission_id == held


def test_one_result_of_many_is_stored(database: Database, queue: Queue, submissions: Submissions) -> None:
    submissions.add(new())
    claim = queue.claim("w")
    stored = at_once(lambda _: queue.finish(claim, result_of(claim), assignment()))
    assert stored == [True] * THREADS  # to the same claim with the same result, the answer is the same
    assert (count(database, "grading"), count(database, "graded_assignment")) == (1, 1)


def test_a_claim_ends_in_one_way_only(
    database: Database, queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    """A result, a failure, a renewal and the end of the lease at the same moment."""
    added = submissions.add(new())
    claim = queue.claim("w")
    clock.advance(16)
    acts = (
        lambda: queue.finish(claim, result_of(claim), assignment()),
        lambda: queue.fail(claim, "no") is not None,
        lambda: queue.reconcile().requeued > 0,
        lambda: queue.hand_back(claim),
    )
    ended = at_once(lambda number: acts[number % len(acts)]())
    assert len({number % len(acts) for number, won in enumerate(ended) if won}) == 1
    state = submissions.get(added.id).state
    assert state is (SubmissionState.GRADED if count(database, "grading") else SubmissionState.QUEUED)


def test_finished_assignments_are_kept_once(
    database: Database, queue: Queue, submissions: Submissions
) -> None:
    for number in range(THREADS):
        submissions.add(new(f"s{number}"))
    claims = [queue.claim("w") for _ in range(THREADS)]
    assert at_once(lambda n: queue.finish(claims[n], result_of(claims[n]), assignment())) == [True] * THREADS
    assert (count(database, "grading"), count(database, "graded_assignment")) == (THREADS, 1)


def test_one_of_many_regrades_is_opened_and_decided_once(
    database: Database, queue: Queue, submissions: Submissions, clock: FakeClock
) -> None:
    added = submissions.add(new())
    claim = queue.claim("w")
    queue.finish(claim, result_of(claim), assignment())
    regrades, signed = Regrades(database), Signature(clock(), None, "wang")
    opened = at_once(lambda _: regrades.open(Wanted(assignment="square", which="all"), signed))
    (regrade,) = (one for one in opened if not isinstance(one, Exception))
    assert {one.code for one in opened if isinstance(one, RefusedError)} == {"regrade_open"}
    trial = queue.claim("w")

    def decide_or_finish(number: int) -> object:
        if number == 0:
            return queue.finish(trial, result_of(trial), assignment())
        return regrades.discard(regrade.id, signed, "no")

    decided = at_once(decide_or_finish)
    assert [one.state for one in decided[1:] if not isinstance(one, Exception)] == [RegradeState.DISCARDED]
    assert {getattr(one, "code", one) for one in decided[1:] if isinstance(one, Exception)} == {
        "regrade_decided"
    }
    assert isinstance(decided[0], bool)
    assert (count(database, "submission"), count(database, "grading")) == (1, 1)
    assert submissions.get(added.id).graded_attempt == 1


def test_rosters_imported_at_once(database: Database, clock: FakeClock, course: str) -> None:
    courses = Courses(database, clock)
    people = [RosterEntry(id=f"s{number}", name="x", role=Role.STUDENT) for number in range(20)]
    changes = at_once(lambda _: courses.import_roster(course, people, "me"))
    assert sorted(len(change.added) for change in changes) == [0] * (THREADS - 1) + [20]
    entries = AuditLog(database).entries(course, 100)
    assert Counter(one.action for one in entries)["member.add"] == 21


def test_a_course_is_created_once(database: Database, clock: FakeClock) -> None:
    made = at_once(lambda _: Courses(database, clock).create("ros", "ROS", "UTC", "me"))
    assert Counter(isinstance(one, CourseError) for one in made) == {True: THREADS - 1, False: 1}


def test_a_frozen_process_gives_its_locks_back(postgres_database: Database, clock: FakeClock) -> None:
    """Its transaction ends on the server's side; whatever it does afterwards fails."""
    added = Submissions(postgres_database, clock).add(new())
    with pytest.raises(Exception, match="does not answer"), postgres_database.writing() as session:  # noqa: PT012
        session.execute(text("UPDATE submission SET trouble = 'mine'"))
        session.execute(text("SET LOCAL idle_in_transaction_session_timeout = 1"))
        gone = text(
            "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND state LIKE 'idle in%'"
        )
        with postgres_database.reading() as watching:
            connection = watching.connection()
            while connection.execute(gone).scalar_one():
                connection.exec_driver_sql("SELECT pg_stat_clear_snapshot()")
        assert Queue(postgres_database, clock, Retries()).claim("w").submission_id == added.id
        session.execute(text("SELECT 1"))


def test_an_appeal_is_answered_once(
    database: Database, clock: FakeClock, queue: Queue, submissions: Submissions, course: str
) -> None:
    id_ = submissions.add(new(course=course)).id
    claim = queue.claim("w")
    assert claim is not None
    queue.finish(claim, result_of(claim), assignment())
    appeals, judgements = Appeals(database), Judgements(database)
    student, signed = Signature(clock(), course, "li"), Signature(clock(), course, "wang")
    appeals.ask(id_, Asked(item="closed", reason="look", attempt=1, earned=0.0, points=5.0), student)

    def answer(number: int) -> None:
        if number % 2:
            appeals.answer(id_, "closed", AppealState.REFUSED, "no", signed)
        else:
            given = Given(item="closed", points=2.0, comment="yes", corrects=True, answers=True)
            judgements.judge_all(id_, [(given, None)], signed)

    made = at_once(answer)
    assert made.count(None) == 1
    assert {one.code for one in made if isinstance(one, RefusedError)} == {
        "appeal_decided",
        "judged_meanwhile",
    }
    (appeal,) = appeals.of(id_)
    corrected = made.index(None) % 2 == 0
    assert appeal.state is (AppealState.CORRECTED if corrected else AppealState.REFUSED)
    assert count(database, "judgement") == int(corrected)


def test_results_that_come_while_a_student_is_forgotten(
    database: Database, clock: FakeClock, queue: Queue, submissions: Submissions, course: str
) -> None:
    claims = []
    for number in range(1, THREADS):
        submissions.add(new(source=b"good # %d" % number, course=course))
        claims.append(queue.claim("w"))
    life, signed = CourseLife(database, clock), Signature(clock(), course, "wang")

    def act(number: int) -> object:
        if number == 0:
            return life.forget("li", signed).submissions
        claim = claims[number - 1]
        return queue.finish(claim, result_of(claim), assignment())

    made = at_once(act)
    assert made[0] == THREADS - 1
    assert {type(one) for one in made[1:]} == {bool}
    assert [count(database, table) for table in ("submission", "grading", "source")] == [0, 0, 0]


def test_no_regrade_is_opened_while_a_course_is_archived(
    database: Database, clock: FakeClock, queue: Queue, submissions: Submissions, course: str
) -> None:
    submissions.add(new(course=course))
    claim = queue.claim("w")
    assert claim is not None
    queue.finish(claim, result_of(claim), assignment())
    life, regrades = CourseLife(database, clock), Regrades(database)
    signed = Signature(clock(), course, "wang")

    def act(number: int) -> object:
        if number % 2:
            return life.archive(signed).archived_at
        return regrades.open(Wanted(assignment="square"), signed).state

    at_once(act)
    archived = Courses(database, clock).get(course).archived_at is not None
    assert archived is (regrades.all(course) == ())


def test_a_notice_is_added_and_taken_on_once(database: Database, clock: FakeClock) -> None:
    Courses(database, clock).create("ros", "ROS", "UTC", "me")
    kept = Notices(database, clock)
    draft = Draft(
        outlet=Outlet.CLASS,
        kind=NoticeKind.DUE,
        heading="x",
        body="x",
        until=clock() + timedelta(days=1),
        told={"due/square": "tomorrow", "due/spin": "tomorrow"},
    )
    assert sorted(at_once(lambda _: kept.add("ros", [draft]))) == [0] * (THREADS - 1) + [1]
    (waiting,) = kept.waiting()
    claims = at_once(lambda _: kept.claim(waiting.id))
    assert [one.id for one in claims if one is not None] == [waiting.id]
    later = replace(draft, told={"due/square": "the day after"})
    assert kept.add("ros", [later, draft]) == 1


def test_a_notice_is_taken_on_while_it_is_taken_away(database: Database, clock: FakeClock) -> None:
    Courses(database, clock).create("ros", "ROS", "UTC", "me")
    kept, signed = Notices(database, clock), Signature(clock(), "ros", "wang")
    hook = NewWebhook(outlet=Outlet.CLASS, vendor=Vendor.WECOM, address="https://a.example/x?key=k")
    until = clock() + timedelta(days=1)
    for turn in range(20):
        kept.set_webhook(hook, signed)
        told = {"due/square": str(turn)}
        draft = Draft(outlet=Outlet.CLASS, kind=NoticeKind.DUE, heading="x", body="x", until=until, told=told)
        assert kept.add("ros", [draft]) == 1
        (waiting,) = kept.waiting()

        def act(number: int, id_: str = waiting.id) -> object:
            return kept.remove_webhook(Outlet.CLASS, signed) if number == 0 else kept.claim(id_)

        removed, *claims = at_once(act)
        assert removed is True
        assert [one for one in claims if isinstance(one, Exception)] == []


def used_by(database: Database, clock: FakeClock, course: str) -> OwnAssignments:
    """Give a course an assignment of its own that it uses."""
    own = OwnAssignments(database, clock)
    uploaded = NewOwnAssignment(assignment="walk", version=1, content=b"zip", reading=b"{}")
    own.add(uploaded, Signature(clock(), course, "wang"))
    claim = own.claim()
    assert claim is not None
    assert own.finish(claim, b"{}", ready=True)
    return own


def test_nothing_is_handed_in_for_an_assignment_that_is_removed_meanwhile(
    database: Database, clock: FakeClock, submissions: Submissions, course: str
) -> None:
    own = used_by(database, clock, course)
    class_ = [RosterEntry(id=f"s{number}", name="", role=Role.STUDENT) for number in range(THREADS)]
    Courses(database, clock).import_roster(course, class_, "me")

    def act(number: int) -> object:
        if number == THREADS // 2:
            return own.remove("walk", Signature(clock(), course, "wang"))
        return submissions.add(new(f"s{number}", course=course, assignment="walk", own=True))

    made = at_once(act)
    removal = made.pop(THREADS // 2)
    refused = {str(one) for one in made if isinstance(one, RefusedError)}
    assert refused <= {"unknown_assignment"}
    assert {type(one) for one in made} <= {RefusedError, Submission}
    if removal is None:
        assert (count(database, "own_assignment"), count(database, "submission")) == (0, 0)
        with pytest.raises(RefusedError, match="unknown_assignment"):
            submissions.add(new(course=course, assignment="walk", own=True))
    else:
        assert str(removal) == "assignment_in_use"
        assert (count(database, "own_assignment"), count(database, "submission")) == (1, THREADS - 1)


def test_a_removal_waits_for_an_upload_that_is_under_way(
    postgres_database: Database, clock: FakeClock
) -> None:
    """What is not committed cannot be seen, so the removal would find nothing handed in."""
    course = open_course(postgres_database, clock)
    own = used_by(postgres_database, clock, course)
    upload = new(course=course, assignment="walk", own=True)
    waits = text("SELECT count(*) FROM pg_locks WHERE NOT granted")
    with ThreadPoolExecutor(1) as pool:
        with postgres_database.writing() as session:
            take_in(session, upload, clock())
            removal = pool.submit(own.remove, "walk", Signature(clock(), course, "wang"))
            with postgres_database.reading() as watching:
                while not watching.connection().execute(waits).scalar_one() and not removal.done():
                    pass
        with pytest.raises(RefusedError, match="assignment_in_use"):
            removal.result()
    assert count(postgres_database, "submission") == 1


def test_uploads_of_a_team_are_counted_for_each_of_it(database: Database, clock: FakeClock) -> None:
    """They wait for each other, and never in a circle."""
    courses, team = Courses(database, clock), ["han", "li", "qian", "zhou"]
    courses.create("teams", "Teams", "UTC", "test")
    courses.import_roster("teams", [RosterEntry(id=one, name=one) for one in team], "test")
    signed = Signature(clock(), "teams", "test")
    StoredRules(database).set("square", Rules(team_size=4, attempts=5), signed)
    Teams(database).set(signed, "square", [team])
    submissions = Submissions(database, clock)

    def upload(number: int) -> Submission:
        source = b"good %d" % number
        return submissions.add(new(team[number % 4], source, course="teams", ruled=True))

    answers = at_once(upload)
    assert [type(one) for one in answers if not isinstance(one, Submission)] == [RefusedError] * 3
    assert [len(submissions.of_student(one, course="teams")) for one in team] == [5] * 4


def test_a_platform_is_removed_while_its_scores_are_sent(
    database: Database, clock: FakeClock, course: str
) -> None:
    """Whoever sends while an instructor removes it has nothing to send, and hinders nobody."""
    platforms, scores = Platforms(database, clock), PlatformScores(database, clock)
    signed = Signature(clock(), course, "wang")
    for round_ in range(5):
        platform = platforms.add(new_platform(client_id=str(round_)), signed)
        assert Identities(database, clock).bind(platform.provider, "3", course, "li", by_token=True)
        links = [
            PlatformLink(
                platform=platform.id,
                resource=str(number),
                title="",
                assignment="square",
                line_item="https://moodle.example/7",
                used_at=clock(),
            )
            for number in range(THREADS)
        ]
        for link in links:
            platforms.open_link(link)

        def act(number: int, links: list[PlatformLink] = links) -> object:
            if number == THREADS - 1:
                return platforms.remove(links[0].platform, signed)
            return [scores.claim(link, course, "li", "digest") for link in links[number:]]

        made = at_once(act)
        assert [one for one in made if isinstance(one, Exception)] == []
        assert made[-1] is True
        assert (count(database, "platform"), count(database, "platform_score")) == (0, 0)
        with pytest.raises(RefusedError, match="platform_unknown"):
            platforms.open_link(links[0])
