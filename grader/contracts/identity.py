"""Courses, the people in them, who asks for something, and what somebody changed."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from typing import Final

from grader.contracts.assignment import DEFAULT_DISTRO, DEFAULT_WAY, Distro, RunsAs
from grader.contracts.errors import CourseError
from grader.contracts.python import StrEnum
from grader.contracts.text import Text

_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._@-]{0,63}")
_LONG_ID = 5  # digits without leading zeros; equal numbers of fewer digits may be two people
_LONGEST_NAME = 200
LONGEST_SECTION = 64
_LONGEST_EMAIL = 254
_SPACES = re.compile(r"[ \u00a0\u2000-\u200a\u202f\u205f\u3000]+")
_WIDENING = re.compile(r"(?<=[\u3400-\u9fff])\s+(?=[\u3400-\u9fff])")
_EMAIL = re.compile(r"[^@\s]+@[^@\s]+")


SESSION_HOURS: Final = 12
MOST_SESSION_HOURS: Final = 24 * 31


class Role(StrEnum):
    """What somebody is in a course.

    Assistants see the work of everybody, or of the sections that they are bound to, and judge what waits for a
    person. They change no settings, and points that a machine gave only where the rules say so.
    """

    STUDENT = "student"
    ASSISTANT = "assistant"
    INSTRUCTOR = "instructor"


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """A course. Days and dates without an offset are meant in its IANA time zone.

    Attributes:
        distro: release of ROS 2 that its scripts find where an assignment names none.
        runs_as: how they are started where an assignment does not say.
        session_hours: how long somebody who signed in on a page stays signed in, at most.
        archived_at: since when it can only be read; None: it is taught.
    """

    id: str
    title: str
    time_zone: str
    created_at: datetime
    distro: Distro = DEFAULT_DISTRO
    session_hours: int = SESSION_HOURS
    runs_as: RunsAs = DEFAULT_WAY
    archived_at: datetime | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """Somebody in a course.

    Attributes:
        id: the student id, or the name an instructor signs with.
        email: may be empty.
        sections: the groups of the course that a student is in, or that an assistant looks after, sorted.
    """

    course: str
    id: str
    name: str
    role: Role
    email: str = ""
    sections: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RosterEntry:
    """One line of a roster: what a person shall be. What it leaves out stays as it is.

    Attributes:
        name: empty: the name that the person has.
        role: None: the role that the person has, student for a new one.
        email, sections: None: those that the person has. Sections replace those.
    """

    id: str
    name: str
    role: Role | None = None
    email: str | None = None
    sections: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TokenInfo:
    """What is known of a bearer token. Its secret is shown once and not kept.

    Attributes:
        id: names the token, for example to revoke it. It gives no access.
    """

    id: str
    course: str
    person: str
    created_at: datetime
    expires_at: datetime
    revoked_at: datetime | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """What a sign-in provider calls a member: who comes with that name is let in as this member.

    Attributes:
        id: names the binding, for example to end it. It gives no access.
        provider: id of the provider. subject: its own name for the person.
        by_token: the person has shown a token once; else the provider said an id of the roster.
    """

    id: str
    provider: str
    subject: str
    course: str
    person: str
    bound_at: datetime
    by_token: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Caller:
    """Who asks.

    Attributes:
        course: None while there are no courses; then nobody's identity is known.
        person: id of the member; None for anybody, and for the operator of a service without courses.
        role: None for anybody.
        students: those of the sections that an assistant is bound to; None: the caller is bound to none.
    """

    course: str | None = None
    person: str | None = None
    role: Role | None = None
    students: frozenset[str] | None = None

    @property
    def is_staff(self) -> bool:
        """Whether the caller may see everybody's work and judge what no machine judges."""
        return self.role in (Role.ASSISTANT, Role.INSTRUCTOR)

    @property
    def is_instructor(self) -> bool:
        """Whether the caller may change settings and grades."""
        return self.role is Role.INSTRUCTOR

    @property
    def signature(self) -> str:
        """How the audit log names the caller."""
        return self.person or ("operator" if self.is_instructor else "anybody")

    def may_see(self, course: str | None, student: str) -> bool:
        """Whether the caller may see the work of `student` in `course`.

        Without courses everybody may: only who knows a submission's id, which cannot be guessed, gets here.
        """
        if course != self.course:
            return False
        return (self.is_staff and self.looks_after(student)) or self.course is None or self.person == student

    def looks_after(self, student: str) -> bool:
        """Whether `student` is in a section of the caller's, who may be bound to some."""
        return self.students is None or student in self.students


ANYBODY = Caller()
"""A caller of a service without courses who shows no token."""

OPERATOR = Caller(role=Role.INSTRUCTOR)
"""A caller of a service without courses who shows the token printed at its start."""


@dataclass(frozen=True, slots=True)
class Seen:
    """Which state of a thing somebody looked at before changing it.

    A change is refused when the thing has another state by then, so that nobody undoes what they never saw.

    Attributes:
        tags: names of the accepted states; None: any state is accepted.
    """

    tags: frozenset[str] | None

    @classmethod
    def one(cls, tag: str) -> "Seen":
        """Accept only the state named `tag`."""
        return cls(frozenset({tag}))

    def includes(self, tag: str) -> bool:
        """Whether the state named `tag` is accepted."""
        return self.tags is None or tag in self.tags


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditEntry:
    """One change of a grade or a setting: who, when, what, before and after.

    Attributes:
        subject: what was changed, e.g. ``member 20260123``.
        before, after: the state as JSON-ready data; None where there was or is nothing.
        reason: as given by who did it; may be empty.
    """

    id: int
    at: datetime
    course: str | None
    actor: str
    action: str
    subject: str
    before: object
    after: object
    reason: str


def sections_of(members: Iterable[Member]) -> list[str]:
    """Return every section that one of `members` is in, sorted."""
    return sorted({name for member in members for name in member.sections})


def is_person_id(text: str) -> bool:
    """Whether `text` can name a student or another member."""
    return _ID.fullmatch(text) is not None


def folded_id(person: str) -> str:
    """Return a form in which all spellings of an id are equal; 1 and 01 stay different (`_LONG_ID`)."""
    number = person.lstrip("0")
    return number if number.isdecimal() and len(number) >= _LONG_ID else person.casefold()


def difference(one: str, other: str) -> Text:
    """Return in what two spellings of an id differ, as the end of a sentence."""
    if one.casefold() == other.casefold():
        return Text(zh="只有大小写不同", en="upper and lower case")
    return Text(
        zh="只差开头的 0：把学号这一列设为“文本”，重新填写学号",
        en="zeros at its beginning: format the column of ids as text and fill it in again",
    )


def checked_id(text: str, what: str) -> str:
    """Return `text` if it can be an id. Raises CourseError: it cannot; `what` names it in the message."""
    if not is_person_id(text):
        raise CourseError(
            f"{text!r} is no {what}: use 1 to 64 letters, digits or . _ @ -, beginning with a letter or digit",
            f"{text!r} 不能用作编号：用 1 到 64 个英文字母、数字或 . _ @ -，以字母或数字开头",
            "id",
        )
    return text


def checked_name(text: str, field: str = "name") -> str:
    """Return a person's or a course's name, which stood in `field`, with single plain spaces inside.

    Raises CourseError: it is too long or cannot be printed.
    """
    name = _SPACES.sub(" ", text).strip()
    if len(name) > _LONGEST_NAME or not name.isprintable():
        raise CourseError(
            f"{name[:40]!r} is no name: use at most {_LONGEST_NAME} printable characters",
            f"{name[:40]!r} 不能用作名字：最多 {_LONGEST_NAME} 个可显示的字符",
            field,
        )
    return name


def person_name(text: str) -> str:
    """Return a person's name as `checked_name` does, without the spaces that widen Chinese ones (张　三)."""
    return checked_name(_WIDENING.sub("", text))


def checked_section(text: str) -> str:
    """Return the name of a section without space around it.

    Raises CourseError: it is empty, too long or cannot be printed.
    """
    section = text.strip()
    if not 0 < len(section) <= LONGEST_SECTION or not section.isprintable():
        raise CourseError(
            f"{section[:40]!r} is no section: use 1 to {LONGEST_SECTION} printable characters",
            f"{section[:40]!r} 不能用作班级名：1 到 {LONGEST_SECTION} 个可显示的字符",
            "sections",
        )
    return section


def checked_email(text: str) -> str:
    """Return an e-mail address without space around it; an empty one is none.

    Raises CourseError: it is no address.
    """
    email = text.strip()
    if email and (len(email) > _LONGEST_EMAIL or not email.isprintable() or not _EMAIL.fullmatch(email)):
        raise CourseError(f"{email[:60]!r} is no e-mail address", f"{email[:60]!r} 不是邮箱地址", "email")
    return email


def checked_entry(entry: RosterEntry) -> RosterEntry:
    """Return an entry whose texts are fit to be stored, without space around them.

    Raises CourseError: one of them is not.
    """
    return RosterEntry(
        id=checked_id(entry.id, "id"),
        name=person_name(entry.name),
        role=entry.role,
        email=None if entry.email is None else checked_email(entry.email),
        sections=None
        if entry.sections is None
        else tuple(checked_section(section) for section in entry.sections),
    )


def no_course(where: str = "") -> CourseError:
    """Return the error for a database without courses; `where` names it."""
    return CourseError(
        f"there is no course yet{where and f' in {where}'}: create one with `grader course create`",
        f"还没有课程{where and f'（{where}）'}：先用 `grader course create` 创建",
    )


def unknown_course(course: str) -> CourseError:
    """Return the error for the id of a course that does not exist."""
    return CourseError(f"there is no course {course!r}", f"没有课程 {course!r}")


def unknown_members(course: str, *people: str) -> CourseError:
    """Return the error for ids of people who are not in a course."""
    ids = ", ".join(people)
    return CourseError(f"course {course} has no member {ids}", f"课程 {course} 没有成员 {ids}")
