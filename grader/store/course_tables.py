"""The tables of courses and their people. What holds for `grader.store.tables` holds here, too."""

from datetime import datetime
from typing import ClassVar

from sqlalchemy import CheckConstraint, ForeignKeyConstraint, Index
from sqlmodel import Field, SQLModel

from grader.contracts.identity import Role
from grader.store.columns import SHA256_LENGTH, instant_column, text_column

_ROLES = ", ".join(f"'{role.value}'" for role in Role)


def _of_member() -> ForeignKeyConstraint:
    return ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"])


class CourseRow(SQLModel, table=True):
    """A course. While there is none, the service asks nobody who they are."""

    __tablename__: ClassVar[str] = "course"

    id: str = Field(primary_key=True, max_length=64)
    title: str = Field(max_length=200)
    time_zone: str = Field(max_length=64)
    created_at: datetime = Field(sa_column=instant_column())


class MemberRow(SQLModel, table=True):
    """Somebody in a course."""

    __tablename__: ClassVar[str] = "member"
    __table_args__ = (CheckConstraint(f"role IN ({_ROLES})", name="member_role"),)

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    name: str = Field(max_length=200)
    role: str = Field(max_length=32)
    created_at: datetime = Field(sa_column=instant_column())


class TokenRow(SQLModel, table=True):
    """A bearer token: only the digest of its secret is kept."""

    __tablename__: ClassVar[str] = "token"
    __table_args__ = (_of_member(), Index("token_owner", "course", "person"))

    id: str = Field(primary_key=True, max_length=16)
    sha256: str = Field(unique=True, max_length=SHA256_LENGTH)
    course: str = Field(max_length=64)
    person: str = Field(max_length=64)
    created_at: datetime = Field(sa_column=instant_column())
    expires_at: datetime = Field(sa_column=instant_column())
    revoked_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))


class AuditRow(SQLModel, table=True):
    """One change of a grade or a setting. Rows are only ever added. `before` and `after` are JSON."""

    __tablename__: ClassVar[str] = "audit"
    __table_args__ = (Index("audit_course", "course", "id"),)

    id: int | None = Field(default=None, primary_key=True)
    at: datetime = Field(sa_column=instant_column())
    course: str | None = Field(default=None, max_length=64)
    actor: str = Field(max_length=64)
    action: str = Field(max_length=64)
    subject: str = Field(max_length=255)
    before: str = Field(sa_column=text_column())
    after: str = Field(sa_column=text_column())
    reason: str = Field(sa_column=text_column())


class RulesRow(SQLModel, table=True):
    """The rules of one assignment in one course, as the JSON of `grader.store.rules`."""

    __tablename__: ClassVar[str] = "rules"

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    document: str = Field(sa_column=text_column())
    changed_at: datetime = Field(sa_column=instant_column())


class ExtensionRow(SQLModel, table=True):
    """What one student gets beyond the rules of one assignment."""

    __tablename__: ClassVar[str] = "extension"
    __table_args__ = (_of_member(),)

    course: str = Field(primary_key=True, max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    due: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    extra_attempts: int
