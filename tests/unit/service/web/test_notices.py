"""What group chats and people are told: each thing once in effect, no name and no points in a group."""

import io
import threading
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import datetime, timedelta
from typing import Any
from zoneinfo import ZoneInfo

import httpx
import pytest
from fastapi import FastAPI

from grader.contracts.identity import Caller, Role, RosterEntry
from grader.contracts.notice import MailWishes, NewWebhook, Outlet, Vendor
from grader.contracts.rules import Extension, Rules, SectionRule, Shown
from grader.contracts.submission import NewSubmission
from grader.outside.notices import NotSentError
from grader.outside.notices.bots import BotChannel
from grader.outside.notices.mail import Letter, MailChannel
from grader.outside.signin import Providers
from grader.store.audit import Signature
from grader.store.notices import Notices
from grader.use_cases import notices
from grader.use_cases.notice_sending import send_notices
from grader.use_cases.notice_writing import write_notices
from grader.use_cases.outbound import Sender
from grader.use_cases.services import Services
from tests.fakes.bots import KEY, SECRET, FakeBots, bots
from tests.unit.service.web.conftest import Browser

ZONE = ZoneInfo("Asia/Shanghai")  # the clock begins on 2 March at 16:00 there
WANG = Caller(course="ros", person="wang", role=Role.INSTRUCTOR)
NAMES = ("li", "han", "李雷", "韩梅梅")
Put = Callable[..., str]


class Postman(MailChannel):
    """Keeps letters instead of sending them; fails as it is told to."""

    kept: list[Letter]
    failing: dict[str, Exception]

    def send(self, letter: Letter) -> None:
        if (failure := self.failing.get(letter.to) or self.failing.get("*")) is not None:
            raise failure
        self.kept.append(letter)

    @property
    def by_person(self) -> list[tuple[str, str]]:
        return [(one.to.partition("@")[0], one.body) for one in self.kept]


def postman() -> Postman:
    made = Postman(server="smtp://localhost", sender="grader@example.edu")
    object.__setattr__(made, "kept", [])
    object.__setattr__(made, "failing", {})
    return made


@pytest.fixture(scope="module")
def listening() -> Iterator[FakeBots]:
    with bots() as known:
        yield known


@pytest.fixture
def group(listening: FakeBots, services: Services) -> FakeBots:
    listening.texts, listening.asked, listening.seen, listening.answer = [], [], [], None
    listening.clock_s = lambda: services.clock().timestamp()
    return listening


@pytest.fixture
def school(
    running: tuple[FastAPI, str], services: Services, group: FakeBots, tokens: dict[str, str]
) -> Services:
    """A course whose people have e-mail addresses; bots may be on this machine."""
    entries = [
        RosterEntry(id="li", name="李雷", email="li@example.edu"),
        RosterEntry(id="han", name="韩梅梅", email="han@example.edu"),
        RosterEntry(id="wang", name="", email="wang@example.edu"),
    ]
    services.courses.import_roster("ros", entries, "test")
    made = replace(
        services,
        providers=Providers(public_url="https://grader.example.edu"),
        bots=BotChannel(lambda: services.clock().timestamp(), private=True),
        mail=postman(),
    )
    running[0].state.services = made
    return made


@pytest.fixture
def post(school: Services) -> Postman:
    assert isinstance(school.mail, Postman)
    return school.mail


def join(services: Services, group: FakeBots, *outlets: Outlet, vendor: Vendor = Vendor.FEISHU) -> None:
    secret = "" if vendor is Vendor.WECOM else SECRET
    for outlet in outlets or (Outlet.CLASS,):
        new = NewWebhook(outlet=outlet, vendor=vendor, address=group.of(vendor), secret=secret)
        notices.set_webhook(services, WANG, new)


def signed(services: Services) -> Signature:
    return Signature(services.clock(), "ros", "wang")


def rule(services: Services, assignment: str = "square", **said: Any) -> None:
    services.rules.set(assignment, Rules(**said), signed(services))


def local(day: int, hour: int, minute: int = 0) -> datetime:
    return datetime(2026, 3, day, hour, minute, tzinfo=ZONE)


def turn_to(services: Services, instant: datetime) -> None:
    services.clock.advance((instant - services.clock()).total_seconds())


def due_tomorrow(services: Services) -> None:
    """Let the square be due at noon of the next day, and the day before be told of it."""
    rule(services, due=local(4, 12))
    turn_to(services, local(3, 9))


def give_up(services: Services, student: str) -> None:
    """Let a submission end through the service's own fault."""
    new = {"course": "ros", "student": student, "assignment": "square", "file_name": "a.py"}
    upload = NewSubmission(source=f"x = '{services.clock()}'".encode(), **new)
    services.intake.accept(upload, services.clock())
    while (claim := services.queue.claim("w")) is not None:
        services.queue.fail(claim, "the physics fell over")
    services.clock.advance(1.0)


# due


def test_the_class_is_told_once_the_day_before(school: Services, group: FakeBots) -> None:
    join(school, group)
    rule(school, due=local(4, 23, 59))
    rule(school, "spin", due=local(5, 0, 0))  # midnight ends the fourth
    assert send_notices(school) == 0
    turn_to(school, local(3, 8, 59))
    assert send_notices(school) == 0
    turn_to(school, local(3, 9, 0))
    assert send_notices(school) == 1
    (told,) = group.texts
    assert "2026-03-04 23:59" in told
    assert "2026-03-05 00:00" in told
    assert told.endswith("https://grader.example.edu/")
    for _ in range(3):
        school.clock.advance(20_000.0)
        assert send_notices(school) == 0


def test_a_date_that_moves_is_told_again_and_only_that(school: Services, group: FakeBots) -> None:
    join(school, group)
    rule(school, due=local(4, 12))
    rule(school, "spin", due=local(4, 12))
    turn_to(school, local(3, 9))
    assert send_notices(school) == 1
    rule(school, due=local(4, 20))
    assert send_notices(school) == 1
    assert "2026-03-04 20:00" in group.texts[1]
    assert "12:00" not in group.texts[1]


@pytest.mark.parametrize(
    "said",
    [
        {"shown": Shown.DRAFT},
        {"shown": Shown.WHEN_OPEN, "opens": local(4, 1)},
        {"by_section": (SectionRule(section="B", due=local(9, 12)),)},  # everybody is in B
    ],
)
def test_what_nobody_sees_or_has_to_do_is_not_told(
    school: Services, group: FakeBots, post: Postman, said: dict[str, Any]
) -> None:
    entries = [RosterEntry(id=one, name="", sections=("B",)) for one in ("li", "han")]
    school.courses.import_roster("ros", entries, "test")
    join(school, group)
    notices.set_mail(school, WANG, MailWishes(due=True))
    rule(school, due=local(4, 12), **said)
    turn_to(school, local(3, 9))
    assert send_notices(school) == 0


def test_a_section_with_a_date_of_its_own_is_named(school: Services, group: FakeBots) -> None:
    school.courses.import_roster("ros", [RosterEntry(id="han", name="", sections=("B",))], "test")
    join(school, group)
    rule(school, due=local(9, 12), by_section=(SectionRule(section="B", due=local(4, 18)),))
    turn_to(school, local(3, 9))
    assert send_notices(school) == 1
    assert "（B）：2026-03-04 18:00" in group.texts[0]


def test_an_extension_is_told_to_its_student_alone(school: Services, group: FakeBots, post: Postman) -> None:
    join(school, group)
    notices.set_mail(school, WANG, MailWishes(due=True))
    rule(school, due=local(3, 12))
    school.rules.extend("square", "han", Extension(due=local(6, 12)), signed(school))
    turn_to(school, local(5, 9))
    assert send_notices(school) == 1
    assert group.texts == []
    ((person, body),) = post.by_person
    assert person == "han"
    assert "2026-03-06 12:00" in body


def test_who_handed_in_gets_no_reminder(school: Services, post: Postman, put: Put) -> None:
    notices.set_mail(school, WANG, MailWishes(due=True))
    put(course="ros", student="li")
    due_tomorrow(school)
    assert send_notices(school) == 1
    assert [person for person, _ in post.by_person] == ["han"]


def test_what_could_not_be_said_before_the_date_is_not_said_after_it(
    school: Services, group: FakeBots
) -> None:
    join(school, group)
    due_tomorrow(school)
    group.answer = 200, {"code": 19024, "msg": "Key Words Not Found"}
    assert send_notices(school) == 0
    turn_to(school, local(4, 12))
    group.answer = None
    assert send_notices(school) == 0
    (late,) = notices.setup_of(school, WANG).latest
    assert (late.body, late.sent_at, late.code) == ("", None, "security")


# graded


def test_a_group_learns_how_much_was_graded_and_nothing_of_anybody(
    school: Services, group: FakeBots, put: Put
) -> None:
    join(school, group, Outlet.CLASS, Outlet.STAFF)
    for student in ("li", "li", "han"):
        put(f"x = '{student}{school.clock()}'".encode(), course="ros", student=student)
    assert send_notices(school) == 0
    turn_to(school, local(2, 18))
    assert send_notices(school) == 1
    (told,) = group.texts
    line = next(one for one in told.splitlines() if "份提交" in one)
    assert line.endswith("3 份提交，2 位学生")
    assert not [name for name in NAMES if name in told.replace("https://grader.example.edu", "")]
    assert "分" not in told.replace("部分", "")
    school.clock.advance(60.0)
    assert send_notices(school) == 0
    turn_to(school, local(3, 18))
    assert send_notices(school) == 0  # nothing was graded
    put(b"y = 1", course="ros", student="li")
    turn_to(school, local(4, 18))
    assert send_notices(school) == 1
    assert "1 份提交，1 位学生" in group.texts[1]


def test_a_group_learns_nothing_of_what_staff_tries_or_of_what_is_hidden(
    school: Services, group: FakeBots, put: Put
) -> None:
    join(school, group)
    rule(school, "hello", shown=Shown.DRAFT)
    turn_to(school, local(3, 12))
    put(course="ros", student="wang")
    put(course="ros", student="wang", assignment="hello")
    put(course="ros", student="li", assignment="hello")
    turn_to(school, local(3, 18))
    assert send_notices(school) == 0
    put(course="ros", student="li")
    put(course="ros", student="wang")
    turn_to(school, local(4, 18))
    assert send_notices(school) == 1
    assert "1 份提交，1 位学生" in group.texts[0]
    assert school.assignments.get("hello").title.zh not in group.texts[0]


def test_a_student_is_told_what_counts_and_only_when_it_changes(
    school: Services, group: FakeBots, post: Postman, put: Put
) -> None:
    put(course="ros", student="han")
    notices.set_mail(school, WANG, MailWishes(graded=True))
    assert send_notices(school) == 0  # what happened before is no news
    put(course="ros", student="li")
    assert send_notices(school) == 1
    ((person, body),) = post.by_person
    assert person == "li"
    assert "5 / 100" in body
    assert "han" not in body
    assert "韩" not in body
    assert send_notices(school) == 0
    school.clock.advance(3_600.0)
    assert send_notices(school) == 0
    rule(school, due=school.clock() - timedelta(days=9), accept_late_s=0)
    assert send_notices(school) == 0  # nothing was lost by it
    assert group.texts == []


def test_many_attempts_are_told_of_together(school: Services, post: Postman, put: Put) -> None:
    notices.set_mail(school, WANG, MailWishes(graded=True))
    put(b"a = 1", course="ros", student="li")
    assert send_notices(school) == 1
    for number in range(6):
        put(f"a = {number} + 2".encode(), course="ros", student="li")
        put(f"a = {number} + 3".encode(), course="ros", student="li", assignment="spin")
        assert send_notices(school) == 0
    school.clock.advance(1_800.0)
    assert send_notices(school) == 1
    assert len(post.kept) == 2
    assert len([one for one in post.kept[1].body.splitlines() if "：" in one]) == 2


def test_hidden_points_are_not_e_mailed_before_their_time(school: Services, post: Postman, put: Put) -> None:
    notices.set_mail(school, WANG, MailWishes(graded=True))
    item = school.assignments.get("square").items[0].id
    rule(school, hidden_items=(item,), hidden_until=school.clock() + timedelta(hours=2))
    put(course="ros", student="li")
    assert send_notices(school) == 1
    assert "100" not in post.kept[0].body
    school.clock.advance(7_200.0)
    assert send_notices(school) == 1
    assert "5 / 100" in post.kept[1].body


# faults


def test_staff_learns_of_faults_and_the_class_does_not(
    school: Services, group: FakeBots, post: Postman
) -> None:
    give_up(school, "han")
    join(school, group, Outlet.CLASS, Outlet.STAFF)
    notices.set_mail(school, WANG, MailWishes(faults=True))
    assert send_notices(school) == 0
    give_up(school, "li")
    give_up(school, "li")
    assert send_notices(school) == 2
    (told,) = group.texts
    assert "2 份提交" in told
    assert not [name for name in NAMES if name in told]
    assert [person for person, _ in post.by_person] == ["wang"]
    school.clock.advance(60.0)
    give_up(school, "li")
    assert send_notices(school) == 0
    school.clock.advance(1_800.0)
    assert send_notices(school) == 2
    assert "1 份提交" in group.texts[1]


def test_that_nothing_is_graded_is_told_once(school: Services, group: FakeBots, put: Put) -> None:
    join(school, group, Outlet.STAFF)
    put(course="ros", student="li", grading=None)
    assert send_notices(school) == 0
    school.clock.advance(900.0)
    assert send_notices(school) == 1
    assert "十五分钟" in group.texts[0]
    school.clock.advance(9_000.0)
    assert send_notices(school) == 0


# once in effect


def test_each_vendors_bot_is_told(school: Services, group: FakeBots) -> None:
    for number, vendor in enumerate(Vendor):
        join(school, group, vendor=vendor)
        rule(school, due=local(4, 12 + number))
        turn_to(school, local(3, 9, number))
        assert send_notices(school) == 1
    assert len(group.texts) == 3


class KilledError(BaseException):
    """As if the process ended here."""


def killed(*_: object, **__: object) -> None:
    raise KilledError


def test_whoever_dies_between_writing_and_sending_loses_nothing(
    school: Services, group: FakeBots, monkeypatch: pytest.MonkeyPatch
) -> None:
    join(school, group)
    due_tomorrow(school)
    with monkeypatch.context() as patch:
        patch.setattr(Notices, "claim", killed)
        with pytest.raises(KilledError):
            send_notices(school)
    assert group.texts == []
    assert send_notices(school) == 1
    assert send_notices(school) == 0
    assert len(group.texts) == 1


def test_whoever_dies_between_sending_and_noting_sends_the_same_again(
    school: Services, post: Postman, put: Put, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same letter, by its id, which mailboxes know; whatever changed meanwhile."""
    notices.set_mail(school, WANG, MailWishes(graded=True))
    put(course="ros", student="li")
    with monkeypatch.context() as patch:
        patch.setattr(Notices, "sent", killed)
        with pytest.raises(KilledError):
            send_notices(school)
    assert send_notices(school) == 0  # another process holds it for two minutes
    school.clock.advance(121.0)
    assert send_notices(school) == 1
    assert post.kept[0] == post.kept[1]
    school.clock.advance(3_600.0)
    assert send_notices(school) == 0


def test_two_processes_that_look_at_once_write_one_notice(
    school: Services, group: FakeBots, monkeypatch: pytest.MonkeyPatch
) -> None:
    join(school, group)
    due_tomorrow(school)
    seen = school.notices.notified_states("ros", Outlet.CLASS)
    assert write_notices(school, "ros") == 1
    monkeypatch.setattr(Notices, "notified_states", lambda *_: seen)
    assert write_notices(school, "ros") == 0
    first, second = school.notices.waiting() * 2
    assert school.notices.claim(first.id) is not None
    assert school.notices.claim(second.id) is None


# what is not taken


def tried_minutes(services: Services, group: FakeBots, minutes: int) -> list[int]:
    tried = []
    for minute in range(minutes):
        before = len(group.asked)
        send_notices(services)
        tried += [minute] * (len(group.asked) - before)
        services.clock.advance(60.0)
    return tried


def test_a_bot_that_refuses_is_asked_ever_more_seldom(school: Services, group: FakeBots) -> None:
    join(school, group)
    due_tomorrow(school)
    group.answer = 200, {"code": 19021, "msg": "sign match fail"}
    assert tried_minutes(school, group, 40) == [0, 1, 3, 7, 15, 31]
    (one,) = notices.setup_of(school, WANG).latest
    assert (one.code, one.tries, "19021" in one.trouble) == ("security", 6, True)
    group.answer = None
    school.clock.advance(3_600.0)
    assert send_notices(school) == 1
    assert notices.setup_of(school, WANG).latest[0].code == ""


def test_a_bot_that_has_enough_is_left_alone_for_ten_minutes(school: Services, group: FakeBots) -> None:
    join(school, group)
    due_tomorrow(school)
    group.answer = 200, {"code": 11232, "msg": "frequency limited"}
    assert tried_minutes(school, group, 25) == [0, 10, 20]


def test_a_new_secret_sends_at_once_what_waited(school: Services, group: FakeBots) -> None:
    join(school, group)
    due_tomorrow(school)
    group.answer = 200, {"code": 19021, "msg": "sign match fail"}
    assert send_notices(school) == 0
    group.answer = None
    join(school, group)
    assert send_notices(school) == 1


def test_one_group_that_is_down_keeps_nobody_else_waiting(
    school: Services, group: FakeBots, post: Postman
) -> None:
    dead = NewWebhook(
        outlet=Outlet.CLASS, vendor=Vendor.WECOM, address="http://127.0.0.1:9/cgi-bin/webhook/send?key=x"
    )
    school.notices.set_webhook(dead, signed(school))
    join(school, group, Outlet.STAFF)
    notices.set_mail(school, WANG, MailWishes(due=True, faults=True))
    due_tomorrow(school)
    give_up(school, "li")
    assert send_notices(school) == 3  # staff's group, the instructor, and one reminder: li has handed in
    assert len(group.texts) == 1
    assert {one.code for one in notices.setup_of(school, WANG).latest} == {"", "unreachable"}


def test_an_address_that_takes_nothing_stops_nobody_elses_letters(school: Services, post: Postman) -> None:
    notices.set_mail(school, WANG, MailWishes(due=True))
    due_tomorrow(school)
    post.failing["li@example.edu"] = NotSentError("recipient", "550 no such user")
    assert send_notices(school) == 1
    assert [person for person, _ in post.by_person] == ["han"]


def test_a_mail_server_that_is_down_is_asked_once_in_a_while(school: Services, post: Postman) -> None:
    notices.set_mail(school, WANG, MailWishes(due=True))
    due_tomorrow(school)
    post.failing["*"] = NotSentError("unreachable", "refused")
    asked: list[int] = []
    whole = Notices.failed

    def counted(self: Notices, *said: Any, **others: Any) -> None:
        asked.append(1)
        whole(self, *said, **others)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Notices, "failed", counted)
        for _ in range(8):
            send_notices(school)
            school.clock.advance(60.0)
    assert len(asked) == 4  # at 0, 1, 3 and 7 minutes, for all letters together
    post.failing.clear()
    school.clock.advance(600.0)
    assert send_notices(school) == 2


def test_whatever_goes_wrong_with_a_course_the_others_are_told(
    school: Services, group: FakeBots, monkeypatch: pytest.MonkeyPatch
) -> None:
    school.courses.create("aaa", "First", "UTC", "test")
    away = NewWebhook(outlet=Outlet.CLASS, vendor=Vendor.FEISHU, address=group.of("feishu"), secret="x")
    school.notices.set_webhook(away, Signature(school.clock(), "aaa", "x"))
    join(school, group)
    due_tomorrow(school)
    whole = Notices.notified_states

    def told(self: Notices, course: str, outlet: Outlet) -> Any:
        if course == "aaa":
            raise RuntimeError("nobody thought of this")
        return whole(self, course, outlet)

    monkeypatch.setattr(Notices, "notified_states", told)
    assert send_notices(school) == 1


def test_whatever_goes_wrong_with_a_letter_the_others_are_sent(school: Services, post: Postman) -> None:
    notices.set_mail(school, WANG, MailWishes(due=True))
    due_tomorrow(school)
    post.failing["li@example.edu"] = RuntimeError("nobody thought of this")
    post.failing["han@example.edu"] = RuntimeError("nor of this")
    write_notices(school, "ros")
    assert send_notices(school) == 0
    del post.failing["han@example.edu"]
    school.clock.advance(120.0)
    assert send_notices(school) == 1
    assert [name for name, _ in post.by_person] == ["han"]


def test_who_left_gets_no_letter(school: Services, post: Postman, group: FakeBots) -> None:
    notices.set_mail(school, WANG, MailWishes(due=True))
    join(school, group)
    due_tomorrow(school)
    assert write_notices(school, "ros") == 3
    school.courses.remove("ros", ["li"], "wang")
    school.courses.import_roster("ros", [RosterEntry(id="han", name="", email="")], "test")
    assert send_notices(school) == 1
    assert post.kept == []


def test_who_leaves_meanwhile_leaves_no_notice(
    school: Services, post: Postman, monkeypatch: pytest.MonkeyPatch
) -> None:
    notices.set_mail(school, WANG, MailWishes(due=True))
    due_tomorrow(school)
    whole = Notices.add

    def left(self: Notices, course: str, drafts: Any) -> int:
        school.course_life.forget("li", signed(school))
        return whole(self, course, drafts)

    monkeypatch.setattr(Notices, "add", left)
    assert write_notices(school, "ros") == 1
    assert {person for person, _ in school.notices.notified_states("ros", Outlet.MAIL)} == {"han"}


def test_an_archived_course_tells_nothing(school: Services, group: FakeBots) -> None:
    join(school, group)
    due_tomorrow(school)
    assert write_notices(school, "ros") == 1
    school.course_life.archive(signed(school))
    assert send_notices(school) == 0
    assert group.asked == []
    notices.remove_webhook(school, WANG, Outlet.CLASS)
    assert notices.setup_of(school, WANG).latest == ()


def test_nothing_of_a_forgotten_student_is_left(
    school: Services, post: Postman, put: Put, group: FakeBots
) -> None:
    notices.set_mail(school, WANG, MailWishes(graded=True))
    put(course="ros", student="li")
    assert write_notices(school, "ros") == 1
    school.course_life.forget("li", signed(school))
    assert school.notices.latest("ros", 9) == ()
    assert school.notices.notified_states("ros", Outlet.MAIL) == {}
    assert send_notices(school) == 0


def test_words_are_kept_no_longer_than_needed(school: Services, post: Postman, put: Put) -> None:
    notices.set_mail(school, WANG, MailWishes(graded=True))
    put(course="ros", student="li")
    assert send_notices(school) == 1
    (kept,) = school.notices.latest("ros", 9)
    assert (kept.body, kept.sent_at is None) == ("", False)
    school.clock.advance(31 * 86_400.0)
    put(b"z = 1", course="ros", student="li")
    assert send_notices(school) == 1
    assert len(school.notices.latest("ros", 9)) == 1


def test_no_grading_and_no_score_waits_for_a_webhook(
    school: Services, put: Put, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While one hangs, submissions are graded and platforms are told; a stop waits for it."""
    hanging, free, scored = threading.Event(), threading.Event(), threading.Event()

    def hang(*_: object) -> int:
        hanging.set()
        assert free.wait(60.0)
        return 0

    for every in ("_SCORES_EVERY_S", "_NOTICES_EVERY_S"):
        monkeypatch.setattr(f"grader.use_cases.outbound.{every}", 0.01)
    monkeypatch.setattr("grader.use_cases.outbound.send_notices", hang)
    monkeypatch.setattr("grader.use_cases.outbound.send_scores", lambda *_: scored.set())
    with Sender(school):
        assert hanging.wait(60.0)
        scored.clear()
        put(course="ros", student="li")  # is graded
        assert scored.wait(60.0)
        free.set()
    assert school.dashboard.state("ros").progress[0].best_score == 5.0


# setting up


def test_a_webhook_is_set_tried_and_removed_on_the_page(
    client: httpx.Client, school: Services, group: FakeBots, tokens: dict[str, str]
) -> None:
    browser = Browser(client)
    browser.enter(token=tokens["wang"])
    form = {"outlet": "class", "vendor": "feishu", "address": group.of("feishu"), "secret": SECRET}
    page = "/class/notices"
    assert browser.post(f"{page}/webhook", form, page=page).headers["Location"] == f"{page}?done=saved"
    shown = browser.get(f"{page}?done=saved").text
    assert "已保存" in shown
    assert group.address.removeprefix("http://") in shown
    assert KEY not in shown
    assert SECRET not in shown
    assert browser.post(f"{page}/test", {"outlet": "class"}).headers["Location"].endswith("done=sent")
    assert "测试消息" in group.texts[0]
    refused = browser.post(f"{page}/webhook", {**form, "vendor": "wecom"})
    assert refused.status_code == 422
    assert "https://qyapi.weixin.qq.com/cgi-bin/webhook/send?key=…" in refused.text
    assert KEY not in refused.text
    assert SECRET not in refused.text
    browser.post(f"{page}/webhook", {**form, "secret": "wrong"})
    told = browser.post(f"{page}/test", {"outlet": "class"})
    assert told.status_code == 502
    assert "19021" in told.text
    assert "核对签名密钥" in told.text
    assert KEY not in told.text
    assert browser.post(f"{page}/remove", {"outlet": "class"}).headers["Location"].endswith("removed")
    assert browser.post(f"{page}/remove", {"outlet": "class"}).status_code == 404
    audit = browser.get("/class/audit").text
    assert "设置群机器人" in audit
    assert "移除群机器人" in audit
    assert KEY not in audit
    assert SECRET not in audit


def test_e_mail_is_chosen_and_tried_on_the_page(
    client: httpx.Client, school: Services, post: Postman, tokens: dict[str, str]
) -> None:
    browser = Browser(client)
    browser.enter(token=tokens["wang"])
    page = "/class/notices"
    browser.post(f"{page}/mail", {"graded": "true"}, page=page)
    assert school.notices.wishes("ros") == MailWishes(graded=True)
    assert browser.get(page).text.count(" checked") == 1
    browser.post(f"{page}/test", {"outlet": "mail"})
    assert post.kept[0].to == "wang@example.edu"
    browser.post(f"{page}/mail", {})
    assert not school.notices.wishes("ros")
    school.courses.import_roster("ros", [RosterEntry(id="wang", name="", email="")], "test")
    assert browser.post(f"{page}/test", {"outlet": "mail"}).status_code == 409


def test_without_a_mail_server_the_page_says_so(
    client: httpx.Client, running: tuple[FastAPI, str], school: Services, tokens: dict[str, str]
) -> None:
    running[0].state.services = replace(school, mail=None)
    browser = Browser(client)
    browser.enter(token=tokens["wang"])
    assert "GRADER_MAIL_SERVER" in browser.get("/class/notices").text
    assert browser.post("/class/notices/mail", {"due": "true"}).status_code == 409


def test_the_interface_shows_no_secret_either(
    client: httpx.Client, school: Services, group: FakeBots, tokens: dict[str, str]
) -> None:
    headers = {"Authorization": f"Bearer {tokens['wang']}"}
    root = "/api/v1/course/notices"
    body = {"vendor": "dingtalk", "address": group.of("dingtalk"), "secret": SECRET}
    assert client.put(f"{root}/webhooks/staff", json=body, headers=headers).status_code == 204
    wishes = {"due": True, "graded": True, "faults": True}
    assert client.put(f"{root}/mail", json=wishes, headers=headers).status_code == 204
    assert client.post(f"{root}/staff/test", headers=headers).status_code == 204
    assert client.post(f"{root}/class/test", headers=headers).json()["code"] == "webhook_not_found"
    shown = client.get(root, headers=headers)
    (hook,) = shown.json()["webhooks"]
    assert (hook["vendor"], hook["outlet"], hook["signed"]) == ("dingtalk", "staff", True)
    assert shown.json()["mail"] == wishes
    assert KEY not in shown.text
    assert SECRET not in shown.text
    wrong = client.put(f"{root}/webhooks/staff", json={**body, "secret": SECRET * 50}, headers=headers)
    assert wrong.status_code == 422
    assert SECRET not in wrong.text
    wrong = client.put(f"{root}/webhooks/staff", json={**body, "vendor": "feishu"}, headers=headers)
    assert (wrong.json()["code"], wrong.json()["field"]) == ("invalid_webhook", "address")
    assert KEY not in wrong.text
    assert client.put(f"{root}/webhooks/mail", json=body, headers=headers).status_code == 422
    assert client.delete(f"{root}/webhooks/staff", headers=headers).status_code == 204
    assert client.delete(f"{root}/webhooks/staff", headers=headers).status_code == 404


def test_messages_to_try_are_few(
    client: httpx.Client, school: Services, group: FakeBots, tokens: dict[str, str]
) -> None:
    join(school, group)
    headers = {"Authorization": f"Bearer {tokens['wang']}"}
    answers = [
        client.post("/api/v1/course/notices/class/test", headers=headers).status_code for _ in range(6)
    ]
    assert answers == [204] * 5 + [429]


def test_no_key_is_in_the_export_or_in_a_log(
    client: httpx.Client,
    school: Services,
    group: FakeBots,
    tokens: dict[str, str],
    caplog: pytest.LogCaptureFixture,
) -> None:
    join(school, group)
    due_tomorrow(school)
    group.answer = 503, b""
    with caplog.at_level("INFO", logger="grader"):
        send_notices(school)
    assert "a notice is not taken now" in caplog.text
    assert KEY not in caplog.text
    headers = {"Authorization": f"Bearer {school.tokens.issue('ros', 'wang', timedelta(days=30), 'x')[1]}"}
    content = client.get("/api/v1/course/export.zip", headers=headers).content
    with zipfile.ZipFile(io.BytesIO(content)) as zipped:
        whole = b"".join(zipped.read(name) for name in zipped.namelist())
    assert KEY.encode() not in whole
    assert SECRET.encode() not in whole
