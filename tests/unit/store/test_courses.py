import hashlib
import re
from collections.abc import Callable, Iterable
from datetime import timedelta

import pytest
from sqlmodel import SQLModel

from grader.contracts.errors import CourseError
from grader.contracts.identity import Member, Role, RosterEntry
from grader.contracts.rules import Extension
from grader.store.audit import AuditLog, Signature
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.rules import ANY_STATE, StoredRules
from grader.store.tables import TokenRow
from grader.store.tokens import Tokens, code_in, digest_of
from tests.fakes.clock import FakeClock


@pytest.fixture
def courses(database: Database, clock: FakeClock) -> Courses:
    made = Courses(database, clock)
    made.create("ros", "ROS 2 入门", "Asia/Shanghai", "me")
    return made


def entry(person: str, name: str = "x", role: Role | None = Role.STUDENT) -> RosterEntry:
    return RosterEntry(id=person, name=name, role=role)


LISTED = [
    entry("20260001", "李雷", None),
    entry("20260002", "韩梅梅"),
    entry("ta", "助教", Role.ASSISTANT),
]


def ids(members: Iterable[Member]) -> list[str]:
    return [one.id for one in members]


def test_a_database_begins_without_courses(database: Database, clock: FakeClock) -> None:
    courses = Courses(database, clock)
    assert not courses.exist()
    courses.create("ros", "ROS", "UTC", "me")
    assert courses.exist()
    assert [course.id for course in Courses(database, clock).all()] == ["ros"]


def test_a_course_without_a_title_is_called_by_its_id(courses: Courses) -> None:
    assert [courses.create(f"c{len(blank)}", blank, "UTC", "me").title for blank in ("", " \u3000")] == [
        "c0",
        "c2",
    ]


@pytest.mark.parametrize(
    ("course", "title", "zone", "why"),
    [
        ("ros", "x", "UTC", "already"),
        ("Ros", "x", "UTC", "there is a course ros already"),
        ("a b", "x", "UTC", "id of a course"),
        ("new", "a\nb", "UTC", "no name"),
        ("new", "x", "Mars/Olympus", "time zone"),
        ("new", "x", "../../etc/passwd", "time zone"),
        ("new", "x", "", "time zone"),
    ],
)
def test_a_course_that_cannot_be(courses: Courses, course: str, title: str, zone: str, why: str) -> None:
    with pytest.raises(CourseError, match=why):
        courses.create(course, title, zone, "me")
    assert len(courses.all()) == 1


def test_importing_again_changes_only_what_changed(courses: Courses, database: Database) -> None:
    first = courses.import_roster("ros", LISTED, "wang")
    assert (len(first.added), len(first.changed), first.unchanged) == (3, 0, 0)
    later = courses.import_roster(
        "ros", [entry("ta", "助教", Role.INSTRUCTOR), entry("20260001", "李雷")], "wang"
    )
    assert (ids(later.added), ids(one.after for one in later.changed), later.unchanged) == ([], ["ta"], 1)
    assert ids(later.gone) == ["20260002"]
    assert [one.id for one in courses.members("ros", Role.INSTRUCTOR)] == ["ta"]
    newest = AuditLog(database).entries("ros", 1)[0]
    assert (newest.actor, newest.action, newest.subject) == ("wang", "member.change", "member ta")
    assert newest.before == {"name": "助教", "role": "assistant"}
    assert newest.after == {"name": "助教", "role": "instructor"}


def test_who_is_in_the_course_keeps_the_role_unless_the_roster_names_one(courses: Courses) -> None:
    courses.import_roster("ros", LISTED, "wang")
    entries = [entry("ta", "韩", None), entry("3", "新", None), entry("20260001", "", None)]
    later = courses.import_roster("ros", entries, "wang")
    assert (ids(later.added), ids(one.after for one in later.changed), later.unchanged) == (["3"], ["ta"], 1)
    assert [(one.id, one.name) for one in courses.members("ros", Role.ASSISTANT)] == [("ta", "韩")]
    assert [one.id for one in courses.members("ros", Role.STUDENT)] == ["20260001", "20260002", "3"]
    assert courses.member("ros", "20260001").name == "李雷"  # an empty name takes none away
    courses.import_roster("ros", [entry("ta", "韩")], "wang")
    assert courses.member("ros", "ta").role is Role.STUDENT


def test_a_preview_changes_nothing(courses: Courses, database: Database) -> None:
    courses.import_roster("ros", LISTED, "wang")
    before, logged = courses.members("ros"), len(AuditLog(database).entries("ros", 100))
    entries = [entry("20260001", "李磊"), entry("new")]
    seen = courses.preview_roster("ros", entries)
    assert courses.members("ros") == before
    assert len(AuditLog(database).entries("ros", 100)) == logged
    assert seen == courses.import_roster("ros", entries, "wang")
    assert [(one.before.name, one.after.name) for one in seen.changed] == [("李雷", "李磊")]


def test_addresses_and_sections_stay_unless_the_roster_has_others(courses: Courses) -> None:
    first = RosterEntry(id="li", name="李", email="li@a.cn", sections=("b", "a"))
    courses.import_roster("ros", [first], "wang")
    courses.import_roster("ros", [entry("li", "李雷")], "wang")
    li = courses.member("ros", "li")
    assert (li.name, li.email, li.sections) == ("李雷", "li@a.cn", ("a", "b"))
    courses.import_roster("ros", [RosterEntry(id="li", name="", sections=("c",))], "wang")
    assert courses.members("ros")[0].sections == ("c",)


def test_an_id_in_another_case_is_nobody_new(courses: Courses) -> None:
    courses.import_roster("ros", [entry("S001")], "wang")
    with pytest.raises(CourseError, match="s001 differs from the member S001"):
        courses.import_roster("ros", [entry("2"), entry("s001")], "wang")
    assert ids(courses.members("ros")) == ["S001"]


def test_an_id_that_lost_its_zeros_is_nobody_new(courses: Courses) -> None:
    courses.import_roster("ros", [entry("0020260101"), entry("01")], "wang")
    for new in ("20260101", "00020260101"):
        with pytest.raises(CourseError, match=f"{new} differs from the member 0020260101 only in zeros"):
            courses.import_roster("ros", [entry(new)], "wang")
    courses.import_roster("ros", [entry("1"), entry("0020260101")], "wang")
    assert ids(courses.members("ros")) == ["0020260101", "01", "1"]


def test_somebody_removed_is_out_at_once(tokens: Tokens, courses: Courses, database: Database) -> None:
    courses.import_roster("ros", [RosterEntry(id="li", name="李", sections=("a",))], "me")
    StoredRules(database).extend(
        "square",
        "li",
        Extension(extra_attempts=1),
        Signature(FakeClock()(), "ros", "me"),
        "ill",
        seen=ANY_STATE,
    )
    _, secret = tokens.issue("ros", "li", timedelta(days=1), "me")
    courses.remove("ros", ["li"], "wang", "left the course")
    assert tokens.caller(secret) is None
    assert courses.member("ros", "li") is None
    newest = AuditLog(database).entries("ros", 1)[0]
    assert (newest.action, newest.subject, newest.reason) == ("member.remove", "member li", "left the course")
    assert newest.before == {"name": "李", "role": "student", "sections": ["a"]}
    courses.import_roster("ros", [entry("li")], "wang")
    assert courses.member("ros", "li").sections == ()


def test_a_course_keeps_an_instructor(tokens: Tokens, courses: Courses) -> None:
    with pytest.raises(CourseError, match="no instructor"):
        courses.remove("ros", ["li", "wang"], "me")
    with pytest.raises(CourseError, match="no instructor"):
        courses.import_roster("ros", [entry("wang", role=Role.STUDENT)], "me")
    with pytest.raises(CourseError, match="no member nobody"):
        courses.remove("ros", ["li", "nobody"], "me")
    assert ids(courses.members("ros")) == ["li", "wang"]


def test_an_import_into_no_course_changes_nothing(courses: Courses, database: Database) -> None:
    before = len(AuditLog(database).entries("ros", 100))
    with pytest.raises(CourseError, match="no course"):
        courses.import_roster("rso", [entry("a")], "me")
    assert len(AuditLog(database).entries("ros", 100)) == before


@pytest.fixture
def tokens(courses: Courses, database: Database, clock: FakeClock) -> Tokens:
    courses.import_roster("ros", [entry("li"), entry("wang", role=Role.INSTRUCTOR)], "me")
    return Tokens(database, clock)


def test_a_token_names_its_owner(tokens: Tokens) -> None:
    info, secret = tokens.issue("ros", "wang", timedelta(days=1), "me")
    caller = tokens.caller(secret)
    assert (caller.course, caller.person, caller.role) == ("ros", "wang", Role.INSTRUCTOR)
    assert tokens.caller(secret[:-1]) is None
    assert tokens.caller(info.id) is None
    assert tokens.caller("") is None


def test_only_a_digest_is_kept(tokens: Tokens, database: Database) -> None:
    _, secret = tokens.issue("ros", "li", timedelta(days=1), "me")
    with database.reading() as session:
        tables = SQLModel.metadata.sorted_tables
        dump = repr([tuple(row) for table in tables for row in session.execute(table.select())])
    for shown in (secret, secret.replace("-", ""), hashlib.sha256(secret.encode()).hexdigest()):
        assert shown not in dump


@pytest.mark.parametrize(
    "retyped",
    [str.lower, lambda code: code.replace("-", " "), lambda code: f" {code.replace('-', '')}\n",
     lambda code: code.replace("-", "－").replace("2", "Z").replace("5", "s"),
     lambda code: "".join(chr(ord(one) + 0xFEE0) for one in code)],
    ids=["small", "spaced", "whole", "look-alikes", "full width"],
)  # fmt: skip
def test_a_token_may_be_typed_as_people_type(tokens: Tokens, retyped: Callable[[str], str]) -> None:
    _, secret = tokens.issue("ros", "li", timedelta(days=1), "me")
    assert re.fullmatch("[2-9AC-FHJKMNP-RTV-Y]{5}-[2-9AC-FHJKMNP-RTV-Y]{5}", secret)
    assert tokens.caller(retyped(secret)).person == "li"
    assert code_in(secret + "2") is None


def test_tokens_of_before_go_on_working(tokens: Tokens, database: Database) -> None:
    info, _ = tokens.issue("ros", "li", timedelta(days=1), "me")
    old = "grader_" + "x" * 43
    with database.writing() as session:
        session.get_one(TokenRow, info.id).sha256 = digest_of(old)
    assert tokens.caller(old).person == "li"


def test_a_token_is_for_members_only(tokens: Tokens) -> None:
    with pytest.raises(CourseError, match="no member"):
        tokens.issue("ros", "nobody", timedelta(days=1), "me")


def test_a_role_taken_away_is_gone_at_once(tokens: Tokens, courses: Courses) -> None:
    _, secret = tokens.issue("ros", "wang", timedelta(days=1), "me")
    courses.import_roster("ros", [entry("han", role=Role.INSTRUCTOR), entry("wang")], "me")
    assert tokens.caller(secret).role is Role.STUDENT


def test_one_token_is_revoked_by_its_id(tokens: Tokens, database: Database) -> None:
    first, first_secret = tokens.issue("ros", "li", timedelta(days=1), "me")
    _, second_secret = tokens.issue("ros", "li", timedelta(days=1), "me")
    assert tokens.revoke("other", "me", token_id=first.id) == 0
    assert tokens.revoke("ros", "me", token_id=first.id) == 1
    assert tokens.revoke("ros", "me", token_id=first.id) == 0
    assert tokens.caller(first_secret) is None
    assert tokens.caller(second_secret) is not None
    assert AuditLog(database).entries("ros", 1)[0].action == "token.revoke"
