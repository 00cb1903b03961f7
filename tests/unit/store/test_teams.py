"""Teams on both databases: an upload is a submission of each, and so are points and comments."""

import pytest

from grader.contracts.errors import RefusedError
from grader.contracts.grading import GradingJob
from grader.contracts.identity import RosterEntry
from grader.contracts.rules import Rules
from grader.contracts.submission import NewSubmission, Submission
from grader.store.audit import AuditLog, Signature
from grader.store.comments import Comments
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.judgements import Given, Judgements, WaitingFor
from grader.store.queue import Queue
from grader.store.rules import StoredRules
from grader.store.teams import Teams
from tests.fakes.clock import FakeClock
from tests.fakes.essays import ANSWER, grade_essay, question
from tests.fakes.submissions import Submissions

PEOPLE = ("han", "li", "qian")


@pytest.fixture
def teams(database: Database, clock: FakeClock) -> Teams:
    """Of a course where three students hand an essay in by two at most."""
    courses = Courses(database, clock)
    courses.create("ros", "ROS", "Asia/Shanghai", "test")
    courses.import_roster("ros", [RosterEntry(id=one, name=one) for one in PEOPLE], "test")
    ruled(database, clock, team_size=2)
    return Teams(database)


def ruled(database: Database, clock: FakeClock, **rules: object) -> None:
    StoredRules(database).set("essay", Rules(**rules), by("wang", clock))


def by(person: str, clock: FakeClock) -> Signature:
    return Signature(clock(), "ros", person)


def essay(student: str, source: bytes = ANSWER, **others: object) -> NewSubmission:
    return NewSubmission(
        course="ros",
        student=student,
        assignment="essay",
        file_name="a.txt",
        source=source,
        ruled=True,
        **others,
    )


def of(submissions: Submissions, student: str) -> list[Submission]:
    return list(submissions.of_student(student, course="ros"))


def grade_all(queue: Queue) -> None:
    while (claim := queue.claim("w")) is not None:
        job = GradingJob(file_name="a.txt", source=claim.source, assignment=question())
        queue.finish(claim, grade_essay(job), question())


def test_students_join_by_code_until_the_team_is_full(teams: Teams, clock: FakeClock) -> None:
    team = teams.join(by("li", clock), "essay", None, 2)
    assert teams.join(by("li", clock), "essay", None, 2).code == team.code
    assert teams.join(by("han", clock), "essay", team.code, 2).members == ("han", "li")
    for person, code, refusal in (("qian", team.code, "team_full"), ("qian", "22222222", "team_not_found")):
        with pytest.raises(RefusedError) as refused:
            teams.join(by(person, clock), "essay", code, 2)
        assert refused.value.code == refusal
    teams.leave(by("li", clock), "essay")
    assert [one.members for one in teams.of("ros", "essay")] == [("han",)]
    assert teams.of("ros", "square") == ()


def test_an_upload_of_one_is_a_submission_of_each(
    teams: Teams, clock: FakeClock, submissions: Submissions, queue: Queue
) -> None:
    team = teams.join(by("li", clock), "essay", None, 2)
    alone = submissions.add(essay("li", b"alone"))
    clock.advance(60)
    teams.join(by("han", clock), "essay", team.code, 2)
    first = submissions.add(essay("li", b"together"))
    [mine] = of(submissions, "han")
    assert (alone.team_upload, first.team_upload, mine.team_upload) == (None, first.id, first.id)
    assert (mine.received_at, mine.sha256, mine.id) == (first.received_at, first.sha256, mine.id)
    assert submissions.students_of_upload(first.id) == ("han", "li")
    grade_all(queue)
    assert {of(submissions, one)[0].report_sha256 for one in ("li", "han")} == {
        submissions.get(first.id).report_sha256
    }
    again, repeated = submissions.accept(essay("han", b"together", assignment_version=1))
    assert (again.id, repeated) == (mine.id, True)
    assert len(of(submissions, "li")) == 2


def test_who_comes_later_gets_the_same_bytes_when_they_are_sent_again(
    teams: Teams, clock: FakeClock, submissions: Submissions
) -> None:
    team = teams.join(by("li", clock), "essay", None, 2)
    first = submissions.add(essay("li"))
    teams.join(by("han", clock), "essay", team.code, 2)
    again, repeated = submissions.accept(essay("li", assignment_version=1))
    assert (again.id, repeated) == (first.id, True)
    assert [one.team_upload for one in of(submissions, "han")] == [first.id]


def test_a_key_that_is_sent_again_brings_nothing_more(
    teams: Teams, clock: FakeClock, submissions: Submissions
) -> None:
    teams.set(by("wang", clock), "essay", [["li", "han"]])
    first = submissions.add(essay("li", key="k"))
    assert submissions.accept(essay("li", key="k")) == (first, True)
    assert len(of(submissions, "han")) == 1


def test_what_the_rules_refuse_to_a_mate_is_refused_to_the_team(
    teams: Teams, clock: FakeClock, submissions: Submissions, database: Database
) -> None:
    ruled(database, clock, team_size=2, attempts=1)
    submissions.add(essay("han", b"alone"))
    teams.set(by("wang", clock), "essay", [["li", "han"]])
    with pytest.raises(RefusedError) as refused:
        submissions.add(essay("li"))
    assert refused.value.code == "no_attempts_left"
    assert "han" in refused.value.detail.en
    assert of(submissions, "li") == []


def test_without_the_rule_everybody_hands_in_alone(
    teams: Teams, clock: FakeClock, submissions: Submissions, database: Database
) -> None:
    teams.set(by("wang", clock), "essay", [["li", "han"]])
    ruled(database, clock)
    assert submissions.add(essay("li")).team_upload is None
    assert of(submissions, "han") == []


def test_who_changes_the_team_keeps_what_there_is(
    teams: Teams, clock: FakeClock, submissions: Submissions, database: Database
) -> None:
    team = teams.join(by("li", clock), "essay", None, 2)
    teams.join(by("han", clock), "essay", team.code, 2)
    submissions.add(essay("li", b"one"))
    with pytest.raises(RefusedError) as refused:
        teams.leave(by("han", clock), "essay")
    assert refused.value.code == "team_fixed"
    teams.set(by("wang", clock), "essay", [["han", "qian"], ["li"]])
    assert submissions.add(essay("li", b"two")).team_upload is None
    submissions.add(essay("qian", b"three"))
    assert {one: len(of(submissions, one)) for one in PEOPLE} == {"han": 2, "li": 2, "qian": 1}
    entry = next(one for one in AuditLog(database).entries("ros", 100) if one.action == "team.set")
    assert entry.after == {"teams": [["han", "qian"], ["li"]]}


def test_points_and_comments_are_of_each_and_wait_once(
    teams: Teams, clock: FakeClock, submissions: Submissions, queue: Queue, database: Database
) -> None:
    teams.set(by("wang", clock), "essay", [["li", "han"]])
    submissions.add(essay("li"))
    grade_all(queue)
    judgements, waiting = Judgements(database), WaitingFor(assignment="essay", item="timer")
    [_] = judgements.waiting("ros", waiting, 0, 10)
    [seldom] = judgements.waiting("ros", WaitingFor(item="timer", students=frozenset(["han"])), 0, 10)
    assert seldom.student == "han"
    given = Given(item="timer", points=1.0, comment="好")
    judgements.judge_all(seldom.submission, [(given, None)], by("wang", clock))
    assert judgements.waiting("ros", waiting, 0, 10) == ()
    mine, theirs = (of(submissions, one)[0] for one in ("li", "han"))
    assert (mine.score, mine.to_judge) == (theirs.score, theirs.to_judge)

    comments = Comments(database)
    comments.add(mine.id, "Why?", 1, by("wang", clock), by_student=False)
    comments.add(theirs.id, "So.", None, by("han", clock), by_student=True)
    assert [[each.text for each in comments.of(one.id)] for one in (mine, theirs)] == [["Why?", "So."]] * 2
    assert comments.unseen_by_staff("ros") == {theirs.id: 1}
    assert comments.unseen_by_student("ros", "han") == {theirs.id: 1}


def test_who_is_forgotten_or_removed_leaves_the_others_theirs(
    teams: Teams, clock: FakeClock, submissions: Submissions, database: Database
) -> None:
    teams.set(by("wang", clock), "essay", [["li", "han"]])
    first = submissions.add(essay("li"))
    Courses(database, clock).remove("ros", ["li"], "wang")
    assert [one.members for one in teams.of("ros", "essay")] == [("han",)]
    assert submissions.students_of_upload(first.id) == ("han", "li")
