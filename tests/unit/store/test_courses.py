import hashlib
from datetime import timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlmodel import SQLModel

from grader.contracts.errors import CourseError
from grader.contracts.identity import Role, RosterEntry
from grader.store.audit import AuditLog
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.roster import read_roster
from grader.store.tokens import PREFIX, Tokens
from tests.fakes.clock import FakeClock

ROSTER = "id,name,role\n20260001,李雷,\n20260002,韩梅梅,student\nta,助教,assistant\n".encode()


@pytest.fixture
def courses(database: Database, clock: FakeClock) -> Courses:
    made = Courses(database, clock)
    made.create("ros", "ROS 2 入门", "Asia/Shanghai", "me")
    return made


def entry(person: str, name: str = "x", role: Role | None = Role.STUDENT) -> RosterEntry:
    return RosterEntry(id=person, name=name, role=role)


def test_a_roster_may_have_its_chinese_names() -> None:
    content = "学号,姓名,角色\n1,李雷,学生\n2,助教一,助教\n3,王,\n4,赵,老师\n".encode()
    assert [(one.id, one.role) for one in read_roster(content)] == [
        ("1", Role.STUDENT),
        ("2", Role.ASSISTANT),
        ("3", None),
        ("4", Role.INSTRUCTOR),
    ]
    with pytest.raises(CourseError, match="two columns 'id'"):
        read_roster("学号,id,姓名\n1,2,a\n".encode())


def test_what_a_spreadsheet_did_to_an_id_is_told() -> None:
    with pytest.raises(CourseError, match="spreadsheet shortened"):
        read_roster(b"id,name\n2.02601E+07,a\n")


def test_a_database_begins_without_courses(database: Database, clock: FakeClock) -> None:
    courses = Courses(database, clock)
    assert not courses.exist()
    courses.create("ros", "ROS", "UTC", "me")
    assert courses.exist()
    assert [course.id for course in Courses(database, clock).all()] == ["ros"]


@pytest.mark.parametrize(
    ("course", "title", "zone", "why"),
    [
        ("ros", "x", "UTC", "already"),
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


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "gbk"])
def test_a_roster_comes_from_a_spreadsheet(encoding: str) -> None:
    entries = read_roster(ROSTER.replace(b"\n", b"\r\n").decode().encode(encoding))
    assert [(one.id, one.name, one.role) for one in entries] == [
        ("20260001", "李雷", None),
        ("20260002", "韩梅梅", "student"),
        ("ta", "助教", "assistant"),
    ]


def test_a_roster_needs_no_roles_and_minds_no_other_columns() -> None:
    assert read_roster(b'Name , ID,class\n"Li, Lei",1,3\n') == (entry("1", "Li, Lei", None),)


def test_lines_without_anybody_are_skipped() -> None:
    content = b"id,name,role\r\n,,\r\n\r\n1,a,\r\n , ,\r\n,,,,\r\n"
    assert read_roster(content) == (entry("1", "a", None),)


def test_what_is_wrong_with_a_roster_is_told_in_its_own_words() -> None:
    with pytest.raises(CourseError) as caught:
        read_roster("姓名\n李雷\n".encode())
    assert "“学号”列" in caught.value.told("zh")
    with pytest.raises(CourseError) as caught:
        read_roster("学号,姓名,角色\n1,李雷,班长\n".encode())
    assert "学生、助教、教师" in caught.value.told("zh")


def test_every_wrong_line_is_named() -> None:
    with pytest.raises(CourseError) as caught:
        read_roster("id,name,role\n1,a,\n,b,\n2,c,king\n1,d,\n学号,e,\n3,f\n".encode())
    lines = str(caught.value).splitlines()
    assert lines[0] == "nothing was imported:"
    assert [line.split(":")[0] for line in lines[1:]] == ["line 3", "line 4", "line 5", "line 6"]
    assert "line 2 already" in lines[3]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "no column"),
        (b"id\n1\n", "no column 'name'"),
        (b"id,name,id\n1,a,2\n", "two columns"),
        (b"id,name\n", "nobody"),
        ("id,name\n1,李".encode("utf-16"), "line 1: neither UTF-8 nor GBK"),
        (b'id,name\n1,"a\n', "line"),
    ],
)
def test_a_file_that_is_no_roster(content: bytes, why: str) -> None:
    with pytest.raises(CourseError, match=why):
        read_roster(content)


@given(st.binary(max_size=200) | st.text(max_size=200).map(lambda text: ("id,name\n" + text).encode()))
def test_any_roster_is_read_or_refused(content: bytes) -> None:
    try:
        entries = read_roster(content)
    except CourseError:
        return
    assert len({one.id for one in entries}) == len(entries) > 0


def test_importing_again_changes_only_what_changed(courses: Courses, database: Database) -> None:
    first = courses.import_roster("ros", read_roster(ROSTER), "wang")
    assert (len(first.added), len(first.changed), first.unchanged) == (3, 0, 0)
    later = courses.import_roster(
        "ros", [entry("ta", "助教", Role.INSTRUCTOR), entry("20260001", "李雷")], "wang"
    )
    assert (later.added, later.changed, later.unchanged) == ((), ("ta",), 1)
    assert [one.id for one in courses.members("ros", Role.INSTRUCTOR)] == ["ta"]
    newest = AuditLog(database).entries("ros", 1)[0]
    assert (newest.actor, newest.action, newest.subject) == ("wang", "member.change", "member ta")
    assert newest.before == {"name": "助教", "role": "assistant"}
    assert newest.after == {"name": "助教", "role": "instructor"}


def test_who_is_in_the_course_keeps_the_role_unless_the_roster_names_one(courses: Courses) -> None:
    courses.import_roster("ros", read_roster(ROSTER), "wang")
    later = courses.import_roster(
        "ros", read_roster("学号,姓名\nta,韩\n3,新\n20260001,李雷\n".encode()), "wang"
    )
    assert (later.added, later.changed, later.unchanged) == (("3",), ("ta",), 1)
    assert [(one.id, one.name) for one in courses.members("ros", Role.ASSISTANT)] == [("ta", "韩")]
    assert [one.id for one in courses.members("ros", Role.STUDENT)] == ["20260001", "20260002", "3"]
    courses.import_roster("ros", read_roster("学号,姓名,角色\nta,韩,学生\n".encode()), "wang")
    assert courses.member("ros", "ta").role is Role.STUDENT


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
    assert hashlib.sha256(secret.encode()).hexdigest() in dump
    assert secret not in dump
    assert secret.removeprefix(PREFIX) not in dump


def test_a_token_is_for_members_only(tokens: Tokens) -> None:
    with pytest.raises(CourseError, match="no member"):
        tokens.issue("ros", "nobody", timedelta(days=1), "me")


def test_a_role_taken_away_is_gone_at_once(tokens: Tokens, courses: Courses) -> None:
    _, secret = tokens.issue("ros", "wang", timedelta(days=1), "me")
    courses.import_roster("ros", [entry("wang", role=Role.STUDENT)], "me")
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
