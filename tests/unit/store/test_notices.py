"""Notices on either database: who wants them, what was graded, what waits, what is given up."""

from datetime import timedelta

import pytest

from grader.contracts.grading import GradingJob
from grader.contracts.identity import RosterEntry
from grader.contracts.notice import Draft, MailWishes, NewWebhook, NoticeKind, Outlet, Vendor
from grader.contracts.submission import NewSubmission
from grader.store.audit import Signature
from grader.store.course_life import CourseLife
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.notices import PATIENCE, Notices
from grader.store.queue import Queue
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import assignment, grade
from tests.fakes.submissions import Submissions

SIGNED = Signature(START, "ros", "wang")
HOOK = NewWebhook(outlet=Outlet.CLASS, vendor=Vendor.WECOM, address="https://a.example/x?key=k")


@pytest.fixture
def kept(database: Database, clock: FakeClock) -> Notices:
    courses = Courses(database, clock)
    for course in ("ros", "other"):
        courses.create(course, course, "UTC", "me")
    courses.import_roster("ros", [RosterEntry(id="li", name=""), RosterEntry(id="han", name="")], "me")
    courses.import_roster("other", [RosterEntry(id="x", name="")], "me")
    return Notices(database, clock)


def draft(outlet: Outlet, person: str = "", state: str = "1", kind: NoticeKind = NoticeKind.DUE) -> Draft:
    until = START + timedelta(hours=1)
    return Draft(
        outlet=outlet, kind=kind, person=person, heading="x", body="y", until=until, told={"a": state}
    )


def test_courses_that_want_notices(kept: Notices, database: Database, clock: FakeClock) -> None:
    assert kept.courses() == ()
    kept.set_wishes(MailWishes(faults=True), SIGNED)
    assert kept.courses() == ("ros",)
    kept.set_wishes(MailWishes(), SIGNED)
    assert kept.courses() == ()
    kept.set_webhook(HOOK, SIGNED)
    kept.set_webhook(HOOK, Signature(START, "other", "x"))
    assert kept.courses() == ("other", "ros")
    CourseLife(database, clock).archive(SIGNED)
    assert kept.courses() == ("other",)
    assert kept.webhooks("ros")[Outlet.CLASS].address == HOOK.address
    assert HOOK.address not in repr(kept.webhooks("ros"))


def test_what_was_graded_and_what_was_not(
    kept: Notices, submissions: Submissions, queue: Queue, clock: FakeClock
) -> None:
    for number, student in enumerate(("li", "li", "han", "li")):
        new = {"course": "ros", "student": student, "assignment": "square", "file_name": "a.py"}
        submissions.add(NewSubmission(source=b"good # %d" % number, **new))
        while (claim := queue.claim("w")) is not None:
            if number == 3:
                queue.fail(claim, "fell over")
                clock.advance(60)
                continue
            job = GradingJob(file_name="a.py", source=claim.source, assignment=assignment())
            assert queue.finish(claim, grade(job), assignment())
        clock.advance(1)
    later = clock() + timedelta(seconds=1)
    assert kept.graded_between("ros", START, later) == {"square": (3, 2)}
    assert kept.graded_between("ros", START + timedelta(seconds=2), later) == {"square": (1, 1)}
    assert kept.graded_between("other", START, later) == {}
    ((assignment_id, claims),) = kept.given_up_since("ros", START).values()
    assert (assignment_id, claims > 0) == ("square", True)
    assert kept.given_up_since("ros", later) == {}


def test_a_failure_puts_off_the_others_of_its_outlet(kept: Notices, clock: FakeClock) -> None:
    assert kept.add("ros", [draft(Outlet.CLASS), draft(Outlet.STAFF), draft(Outlet.MAIL, "li")]) == 3
    clock.advance(1)
    assert kept.add("other", [draft(Outlet.CLASS), draft(Outlet.MAIL, "x")]) == 2
    assert kept.add("ros", [draft(Outlet.CLASS, state="2"), draft(Outlet.MAIL, "han")]) == 2
    of = {(one.course, one.outlet, one.person): one for one in kept.waiting()}
    kept.failed(of["ros", Outlet.CLASS, ""], "refused", "no")
    left = {(one.course, one.outlet, one.person) for one in kept.waiting()}
    assert left == set(of) - {("ros", Outlet.CLASS, "")}
    kept.failed(of["ros", Outlet.MAIL, "li"], "recipient", "no", alone=True)
    assert ("ros", Outlet.MAIL, "han") in {(one.course, one.outlet, one.person) for one in kept.waiting()}
    kept.failed(of["ros", Outlet.MAIL, "han"], "unreachable", "no")
    assert {one.outlet for one in kept.waiting()} == {Outlet.STAFF, Outlet.CLASS}
    clock.advance(60)
    assert len(kept.waiting()) == 7


def test_a_clock_that_was_ahead_holds_no_notice_up(kept: Notices, clock: FakeClock) -> None:
    clock.advance(-86_400)
    before = clock()
    clock.advance(86_400)
    assert kept.add("ros", [draft(Outlet.CLASS)]) == 1
    clock.advance(-86_400)
    (waiting,) = kept.waiting()
    assert kept.claim(waiting.id) is not None
    assert kept.made_since("ros", before - timedelta(minutes=30)) == {}


def test_who_is_no_member_gets_none(kept: Notices) -> None:
    assert kept.add("ros", [draft(Outlet.MAIL, "x"), draft(Outlet.CLASS)]) == 1
    assert kept.notified_states("ros", Outlet.MAIL) == {}


def test_what_is_late_is_given_up_and_what_is_unwanted_goes(kept: Notices, clock: FakeClock) -> None:
    kept.set_wishes(MailWishes(due=True, graded=True), SIGNED)
    graded = draft(Outlet.MAIL, "han", kind=NoticeKind.GRADED)
    kept.add("ros", [draft(Outlet.MAIL, "li"), graded])
    kept.set_wishes(MailWishes(due=True), SIGNED)
    (left,) = kept.waiting()
    assert left.person == "li"
    assert kept.claim(left.id) is not None
    assert kept.waiting() == ()
    clock.advance(PATIENCE.total_seconds())
    assert kept.waiting() != ()
    clock.advance(3_600)
    assert kept.claim(left.id) is None
    assert (kept.give_up(), kept.give_up()) == (1, 0)
    (one,) = kept.latest("ros", 5)
    assert (one.body, one.sent_at, kept.waiting()) == ("", None, ())
    assert kept.made_since("ros", START - timedelta(days=1)) == {(Outlet.MAIL, NoticeKind.DUE, "li"): START}
