"""The tables. A new database gets them as they stand here.

Changing one needs a migration in `grader.store.migrations.versions`; a test compares what both lead to.
"""

import gzip
import re
from dataclasses import fields
from datetime import datetime
from typing import Any, Final, TypeVar

from sqlalchemy import (
    CheckConstraint,
    Column,
    DateTime,
    Dialect,
    ForeignKeyConstraint,
    Index,
    LargeBinary,
    Table,
    Text,
)
from sqlalchemy.orm import declared_attr
from sqlalchemy.types import TypeDecorator
from sqlmodel import Field, SQLModel

from grader.contracts.appeal import AppealState
from grader.contracts.assignment import DEFAULT_DISTRO, DEFAULT_WAY
from grader.contracts.identity import SESSION_HOURS, Role
from grader.contracts.own_assignment import OwnState
from grader.contracts.python import UTC, StrEnum
from grader.contracts.regrade import RegradeState
from grader.contracts.report import GradeStatus
from grader.contracts.submission import Submission, SubmissionState

SHA256_LENGTH = 64
# A trajectory gets four and a half times smaller in 0.2 ms; level 4 takes 0.5 ms and gains 6 %.
GZIP_LEVEL = 1
_GZIP = b"\x1f\x8b"  # which no JSON begins with
_Contract = TypeVar("_Contract")


class UtcDateTime(TypeDecorator[datetime]):
    """An instant with a time zone, to the microsecond. One without is refused: its zone would be a guess.

    SQLite stores it as text of fixed width, so comparing the texts compares the instants.
    """

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Convert to UTC before storing."""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError(f"an instant needs a time zone: {value!r}")
        utc = value.astimezone(UTC)
        return utc.replace(tzinfo=None) if dialect.name == "sqlite" else utc

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Give back an aware instant."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)

    def coerce_compared_value(self, op: Any, value: Any) -> "UtcDateTime":
        """Compare with instants by the same rules as they are stored by."""
        return self


class PlainText(TypeDecorator[str]):
    """Text without the character NUL, which PostgreSQL cannot hold; it becomes U+FFFD."""

    impl = Text
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Dialect) -> str | None:
        """Replace before storing."""
        return None if value is None else value.replace("\0", "\ufffd")


class CompressedBytes(TypeDecorator[bytes]):
    """Bytes that are stored compressed by gzip; rows from before are read as they are."""

    impl = LargeBinary
    cache_ok = True

    def process_bind_param(self, value: bytes | None, dialect: Dialect) -> bytes | None:
        """Compress before storing."""
        return None if value is None else gzip.compress(value, GZIP_LEVEL, mtime=0)

    def process_result_value(self, value: bytes | None, dialect: Dialect) -> bytes | None:
        """Give back what was stored."""
        return gzip.decompress(value) if value is not None and value.startswith(_GZIP) else value


def instant_column(*, nullable: bool = False) -> Column[datetime]:
    """Return a column of instants."""
    return Column(UtcDateTime(), nullable=nullable)


def text_column(*, nullable: bool = False) -> Column[str]:
    """Return a column of text of any length."""
    return Column(PlainText(), nullable=nullable)


def bytes_column() -> Column[bytes]:
    """Return a column of bytes."""
    return Column(LargeBinary(), nullable=False)


def _one_of(kinds: type[StrEnum], column: str, name: str) -> CheckConstraint:
    values = ", ".join(f"'{kind.value}'" for kind in kinds)
    return CheckConstraint(f"{column} IN ({values})", name=name)


def _of_member() -> ForeignKeyConstraint:
    return ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"])


class _Row(SQLModel):
    """A row of a table, which is named after its class: ``UploadKeyRow`` is one of ``upload_key``."""

    @declared_attr.directive
    def __tablename__(cls) -> str:  # noqa: N805
        """Return the table's name."""
        return re.sub(r"(?<!^)(?=[A-Z])", "_", cls.__name__.removesuffix("Row")).lower()


class CourseRow(_Row, table=True):
    """A course. While there is none, the service asks nobody who they are."""

    id: str = Field(primary_key=True, max_length=64)
    title: str = Field(max_length=200)
    time_zone: str = Field(max_length=64)
    created_at: datetime = Field(sa_column=instant_column())
    distro: str = Field(
        default=DEFAULT_DISTRO, max_length=32, sa_column_kwargs={"server_default": DEFAULT_DISTRO}
    )
    archived_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    session_hours: int = Field(default=SESSION_HOURS, sa_column_kwargs={"server_default": str(SESSION_HOURS)})
    runs_as: str = Field(default=DEFAULT_WAY, max_length=32, sa_column_kwargs={"server_default": DEFAULT_WAY})
    begun_with: str | None = Field(default=None, sa_column=text_column(nullable=True))


class MemberRow(_Row, table=True):
    """Somebody in a course."""

    __table_args__ = (_one_of(Role, "role", "member_role"),)

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    name: str = Field(max_length=200)
    role: str = Field(max_length=32)
    created_at: datetime = Field(sa_column=instant_column())
    email: str = Field(default="", max_length=254, sa_column_kwargs={"server_default": ""})


class SectionRow(_Row, table=True):
    """A section of a course that a student is in, or that an assistant looks after."""

    __table_args__ = (_of_member(),)

    course: str = Field(primary_key=True, max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    section: str = Field(primary_key=True, max_length=64)


class TokenRow(_Row, table=True):
    """A bearer token, or a browser's session that was opened by one: only the digest of its secret is kept."""

    __table_args__ = (_of_member(), Index("token_owner", "course", "person"))

    id: str = Field(primary_key=True, max_length=16)
    sha256: str = Field(unique=True, max_length=SHA256_LENGTH)
    course: str = Field(max_length=64)
    person: str = Field(max_length=64)
    created_at: datetime = Field(sa_column=instant_column())
    expires_at: datetime = Field(sa_column=instant_column())
    revoked_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    opened_by: str | None = Field(default=None, max_length=16)


class IdentityRow(_Row, table=True):
    """What a provider calls a member: whoever comes with that name is let in as this member."""

    __table_args__ = (_of_member(), Index("identity_subject", "provider", "subject", "course", unique=True))

    id: str = Field(primary_key=True, max_length=16)
    provider: str = Field(max_length=64)
    subject: str = Field(max_length=255)
    course: str = Field(max_length=64)
    person: str = Field(max_length=64)
    bound_at: datetime = Field(sa_column=instant_column())
    by_token: bool


class RecognisedRow(_Row, table=True):
    """Somebody whom a provider recognised a moment ago, who is still asked for a token or a course."""

    sha256: str = Field(primary_key=True, max_length=SHA256_LENGTH)
    provider: str = Field(max_length=64)
    subject: str = Field(max_length=255)
    expires_at: datetime = Field(sa_column=instant_column())


class AuditRow(_Row, table=True):
    """One change of a grade or a setting. Rows are only ever added. `before` and `after` are JSON."""

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


class RulesRow(_Row, table=True):
    """The rules of one assignment in one course, as the JSON of `grader.store.rules`."""

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    document: str = Field(sa_column=text_column())
    changed_at: datetime = Field(sa_column=instant_column())


class ExtensionRow(_Row, table=True):
    """What one student gets beyond the rules of one assignment."""

    __table_args__ = (_of_member(),)

    course: str = Field(primary_key=True, max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    due: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    extra_attempts: int


def _of_grading() -> ForeignKeyConstraint:
    return ForeignKeyConstraint(["submission_id", "attempt"], ["grading.submission_id", "grading.attempt"])


class SourceRow(_Row, table=True):
    """Uploaded bytes, once per content, kept for as long as a submission names them."""

    sha256: str = Field(primary_key=True, max_length=SHA256_LENGTH)
    content: bytes = Field(sa_column=bytes_column())


class SubmissionRow(_Row, table=True):
    """One upload. `attempt` fences, `lease_until` frees; see `grader.store.queue`.

    A row with `regrade` is a trial grading of the row `original`; see `grader.store.regrades`. Waiting rows are
    graded in order of `priority`, then of `turn_at`; see `grader.store.intake`.
    """

    __table_args__ = (
        _one_of(SubmissionState, "state", "submission_state"),
        CheckConstraint("state != 'running' OR lease_until IS NOT NULL", name="running_has_a_lease"),
        Index("submission_queue", "state", "priority", "turn_at", "id", "queued_at"),
        Index("submission_regrade", "regrade"),
        Index("submission_class", "course", "student", "assignment", "received_at"),
        Index("submission_finished", "finished_at"),
        Index("submission_lately", "course", "student", "finished_at"),
        Index("submission_original", "original"),
        Index("submission_team_upload", "team_upload"),
    )

    id: str = Field(primary_key=True, max_length=36)
    course: str | None = Field(default=None, foreign_key="course.id", max_length=64)
    student: str = Field(max_length=64)
    assignment: str = Field(max_length=64)
    file_name: str = Field(max_length=255)
    source_sha256: str = Field(foreign_key="source.sha256", max_length=SHA256_LENGTH)
    size_bytes: int
    state: str = Field(max_length=32)
    priority: int = 0
    received_at: datetime = Field(sa_column=instant_column())
    queued_at: datetime = Field(sa_column=instant_column())
    turn_at: datetime = Field(sa_column=instant_column())
    not_before: datetime = Field(sa_column=instant_column())
    started_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    finished_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    lease_until: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    worker: str = Field(default="", max_length=255)
    attempt: int = 0
    tries: int = 0
    trouble: str = Field(default="", sa_column=text_column())
    graded_attempt: int | None = None
    verdict: str | None = Field(default=None, max_length=32)
    score: float | None = None
    max_score: float | None = None
    report_sha256: str | None = Field(default=None, max_length=SHA256_LENGTH)
    regrade: str | None = Field(default=None, foreign_key="regrade.id", max_length=16)
    original: str | None = Field(default=None, foreign_key="submission.id", max_length=36)
    to_judge: int | None = None
    # the first submission of the upload, which each member of a team has one of; that one may be erased
    team_upload: str | None = Field(default=None, max_length=36)


class RefusedUploadRow(_Row, table=True):
    """An upload of a member that was not accepted."""

    __table_args__ = (_of_member(), Index("refused_of_member", "course", "person", "at"))

    id: str = Field(primary_key=True, max_length=16)
    course: str = Field(max_length=64)
    person: str = Field(max_length=64)
    assignment: str = Field(max_length=64)
    at: datetime = Field(sa_column=instant_column())
    code: str = Field(max_length=32)
    file_name: str = Field(sa_column=text_column())
    line: int | None = None


class UploadKeyRow(_Row, table=True):
    """A key that came with an upload, and a digest of what the upload was. Forgotten after some days."""

    __table_args__ = (Index("upload_key_submission", "submission_id"),)

    owner: str = Field(primary_key=True, max_length=160)
    key: str = Field(primary_key=True, max_length=255)
    digest: str = Field(max_length=SHA256_LENGTH)
    submission_id: str = Field(foreign_key="submission.id", max_length=36)
    at: datetime = Field(sa_column=instant_column())


class GradingRow(_Row, table=True):
    """One finished grading; a re-grade adds a row and leaves the older ones. `report` is canonical bytes.

    `replaced`: the attempt that stood before a re-grade's, None where none did.
    """

    __table_args__ = (Index("grading_regrade", "regrade"),)

    submission_id: str = Field(primary_key=True, foreign_key="submission.id", max_length=36)
    attempt: int = Field(primary_key=True)
    worker: str = Field(max_length=255)
    finished_at: datetime = Field(sa_column=instant_column())
    grader_version: str = Field(max_length=64)
    assignment_version: int
    verdict: str = Field(max_length=32)
    score: float | None = None
    max_score: float
    report_sha256: str = Field(max_length=SHA256_LENGTH)
    report: bytes = Field(sa_column=Column(CompressedBytes(), nullable=False))
    measurements: str = Field(sa_column=text_column())
    # nullable, as in databases that exist; every grading has one
    assignment_sha256: str = Field(
        nullable=True, foreign_key="graded_assignment.sha256", max_length=SHA256_LENGTH
    )
    regrade: str | None = Field(default=None, foreign_key="regrade.id", max_length=16)
    replaced: int | None = None


class GradedAssignmentRow(_Row, table=True):
    """An assignment as it was graded, once per content: a `Record` as canonical JSON."""

    sha256: str = Field(primary_key=True, max_length=SHA256_LENGTH)
    content: bytes = Field(sa_column=bytes_column())


class RegradeRow(_Row, table=True):
    """A re-grade. `wanted` and, once it is decided, `outcome` are JSON of `grader.contracts.regrade`."""

    __table_args__ = (_one_of(RegradeState, "state", "regrade_state"),)

    id: str = Field(primary_key=True, max_length=16)
    course: str | None = Field(default=None, foreign_key="course.id", max_length=64)
    assignment: str = Field(max_length=64)
    state: str = Field(max_length=16)
    wanted: str = Field(sa_column=text_column())
    created_at: datetime = Field(sa_column=instant_column())
    created_by: str = Field(max_length=64)
    decided_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    decided_by: str = Field(default="", max_length=64)
    reason: str = Field(default="", sa_column=text_column())
    outcome: str = Field(default="", sa_column=text_column())
    undone_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    undone_by: str = Field(default="", max_length=64, sa_column_kwargs={"server_default": ""})
    undone_reason: str = Field(default="", sa_column=Column(PlainText(), nullable=False, server_default=""))


class ToldChangeRow(_Row, table=True):
    """What a re-grade, or that it was `undone`, changed of a submission, for its student.

    `change` is JSON of `grader.contracts.regrade`. `seen_at`: the student has seen it.
    """

    submission_id: str = Field(primary_key=True, foreign_key="submission.id", max_length=36)
    regrade: str = Field(primary_key=True, foreign_key="regrade.id", max_length=16)
    undone: bool = Field(primary_key=True)
    change: str = Field(sa_column=text_column())
    at: datetime = Field(sa_column=instant_column())
    seen_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))


class JudgementRow(_Row, table=True):
    """What a person gave for one rubric item. Rows are only ever added: the latest `revision` counts."""

    __table_args__ = (
        _of_grading(),
        CheckConstraint("points >= 0 AND points <= out_of", name="judgement_points"),
    )

    submission_id: str = Field(primary_key=True, max_length=36)
    item: str = Field(primary_key=True, max_length=128)
    revision: int = Field(primary_key=True)
    points: float
    out_of: float
    comment: str = Field(sa_column=text_column())
    judged_by: str = Field(max_length=64)
    judged_at: datetime = Field(sa_column=instant_column())
    attempt: int
    source_sha256: str = Field(foreign_key="source.sha256", max_length=SHA256_LENGTH)


class CommentRow(_Row, table=True):
    """What somebody wrote about a submission. `seen_at`: when the other side, student or staff, first saw it."""

    submission_id: str = Field(primary_key=True, foreign_key="submission.id", max_length=36)
    number: int = Field(primary_key=True)
    written_by: str = Field(max_length=64)
    by_student: bool
    line: int | None = None
    text: str = Field(sa_column=text_column())
    written_at: datetime = Field(sa_column=instant_column())
    seen_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))


class PhraseRow(_Row, table=True):
    """A comment that the staff of a course uses again."""

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    key: str = Field(primary_key=True, max_length=16)
    text: str = Field(sa_column=text_column())


class PinnedRow(_Row, table=True):
    """What every student of a course reads who makes a mistake at an assignment."""

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    mistake: str = Field(primary_key=True, max_length=64)
    text: str = Field(sa_column=text_column())


class AppealRow(_Row, table=True):
    """That a student asks for another look at a rubric item, and the answer. `seen_at`: the student saw that.

    `passed_on_by`: which assistant left it to the instructors, with `note`.
    """

    __table_args__ = (
        _one_of(AppealState, "state", "appeal_state"),
        Index("appeal_waiting", "state", "made_at"),
    )

    submission_id: str = Field(primary_key=True, foreign_key="submission.id", max_length=36)
    item: str = Field(primary_key=True, max_length=128)
    reason: str = Field(sa_column=text_column())
    made_at: datetime = Field(sa_column=instant_column())
    attempt: int
    earned: float
    points: float
    state: str = Field(max_length=16)
    answer: str = Field(default="", sa_column=text_column())
    answered_by: str = Field(default="", max_length=64)
    passed_on_by: str = Field(default="", max_length=64, sa_column_kwargs={"server_default": ""})
    note: str = Field(default="", sa_column=Column(PlainText(), nullable=False, server_default=""))
    answered_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    seen_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))


class GradedItemRow(_Row, table=True):
    """One rubric item of one grading, for counting; the report has the whole of it."""

    __table_args__ = (_of_grading(),)

    submission_id: str = Field(primary_key=True, max_length=36)
    attempt: int = Field(primary_key=True)
    item: str = Field(primary_key=True, max_length=128)
    status: str = Field(max_length=32)
    points: float
    earned: float


class GradedMistakeRow(_Row, table=True):
    """One recognised mistake of one grading. `rank` 0 is the likeliest."""

    __table_args__ = (_of_grading(),)

    submission_id: str = Field(primary_key=True, max_length=36)
    attempt: int = Field(primary_key=True)
    code: str = Field(primary_key=True, max_length=64)
    rank: int


class TrajectoryRow(_Row, table=True):
    """The trajectory of one case of one grading: gzip of its JSON, and the digest of the JSON."""

    __table_args__ = (_of_grading(),)

    submission_id: str = Field(primary_key=True, max_length=36)
    attempt: int = Field(primary_key=True)
    case_id: str = Field(primary_key=True, max_length=64)
    position: int
    sha256: str = Field(max_length=SHA256_LENGTH)
    content: bytes = Field(sa_column=bytes_column())


class ExplanationRow(_Row, table=True):
    """What trials say of a grading: `content`, a `Record` as canonical JSON; None while it is looked for.

    `took_s`: how long was looked for it. See `grader.store.explanations`.
    """

    __table_args__ = (_of_grading(), Index("explanation_waiting", "finished_at", "turn_at"))

    submission_id: str = Field(primary_key=True, max_length=36)
    attempt: int = Field(primary_key=True)
    turn_at: datetime = Field(sa_column=instant_column())
    lease_until: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    tries: int
    took_s: float
    finished_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    content: bytes | None = Field(default=None, sa_column=Column(CompressedBytes(), nullable=True))


class WorkerRow(_Row, table=True):
    """What a worker process last said about itself."""

    id: str = Field(primary_key=True, max_length=255)
    slots: int
    busy: int
    sandbox_ready: bool
    isolation: str = Field(max_length=64)
    detail: str = Field(sa_column=text_column())
    started_at: datetime = Field(sa_column=instant_column())
    seen_at: datetime = Field(sa_column=instant_column())


class OwnAssignmentRow(_Row, table=True):
    """An assignment that somebody uploaded to a course; `number` counts uploads of one assignment.

    The latest that is ``ready`` is used, the latest of all is shown; no others are kept. `content` is the folder
    as a zip; `reading` and `examined` are the records of these names in `grader.grading.examination`, as JSON.
    Bytes, as nothing there names a person. `lease_until`: until when a worker runs the scripts of it.
    """

    __table_args__ = (
        _one_of(OwnState, "state", "own_assignment_state"),
        Index("own_assignment_waiting", "state", "uploaded_at"),
    )

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    number: int = Field(primary_key=True)
    version: int
    state: str = Field(max_length=16)
    content: bytes = Field(sa_column=bytes_column())
    reading: bytes = Field(sa_column=bytes_column())
    examined: bytes = Field(sa_column=bytes_column())
    uploaded_at: datetime = Field(sa_column=instant_column())
    uploaded_by: str = Field(max_length=64)
    not_before: datetime = Field(sa_column=instant_column())
    lease_until: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    tries: int = 0
    trouble: str = Field(default="", sa_column=text_column())


class ReceiptKeyRow(_Row, table=True):
    """The one key that signs receipts."""

    id: int = Field(primary_key=True, sa_column_kwargs={"autoincrement": False})
    secret: bytes = Field(sa_column=bytes_column())


class PlatformKeyRow(_Row, table=True):
    """A key by which the service signs what it says to learning platforms; the newest is used."""

    id: str = Field(primary_key=True, max_length=64)
    secret: str = Field(sa_column=text_column())
    created_at: datetime = Field(sa_column=instant_column())


class PlatformRow(_Row, table=True):
    """A learning platform that a course is used from."""

    __table_args__ = (Index("platform_client", "issuer", "client_id", "deployment", unique=True),)

    id: str = Field(primary_key=True, max_length=16)
    course: str = Field(foreign_key="course.id", max_length=64)
    title: str = Field(max_length=200)
    issuer: str = Field(max_length=255)
    client_id: str = Field(max_length=255)
    deployment: str = Field(max_length=255)
    login_url: str = Field(max_length=1000)
    token_url: str = Field(max_length=1000)
    keys_url: str = Field(max_length=1000)
    people_url: str = Field(default="", max_length=1000, sa_column_kwargs={"server_default": ""})
    created_at: datetime = Field(sa_column=instant_column())


class PlatformInvitationRow(_Row, table=True):
    """An address by which a platform can be added to a course, once. `sha256`: of the secret in it."""

    sha256: str = Field(primary_key=True, max_length=SHA256_LENGTH)
    course: str = Field(foreign_key="course.id", max_length=64)
    actor: str = Field(max_length=64)
    until: datetime = Field(sa_column=instant_column())


class PlatformPickingRow(_Row, table=True):
    """What a platform asks to be chosen. `sha256`: of the secret by which the page of the choice is opened."""

    sha256: str = Field(primary_key=True, max_length=SHA256_LENGTH)
    platform: str = Field(foreign_key="platform.id", max_length=16)
    subject: str = Field(max_length=255)
    back: str = Field(sa_column=text_column())
    data: str = Field(sa_column=text_column())
    several: bool
    scored: bool
    until: datetime = Field(sa_column=instant_column())


class PlatformLinkRow(_Row, table=True):
    """An activity of a platform that was opened."""

    platform: str = Field(primary_key=True, foreign_key="platform.id", max_length=16)
    resource: str = Field(primary_key=True, max_length=255)
    title: str = Field(max_length=255)
    assignment: str = Field(max_length=64)
    line_item: str = Field(max_length=2000)
    used_at: datetime = Field(sa_column=instant_column())


class PlatformScoreRow(_Row, table=True):
    """What a platform was last told of a member at an activity, or is to be told again.

    `sha256`: of what it took; empty: nothing yet. `sent_at`: the instant named in it. Nobody else sends before
    `not_before`. `trouble`: why it did not take the latest.
    """

    __table_args__ = (
        ForeignKeyConstraint(["platform", "resource"], ["platform_link.platform", "platform_link.resource"]),
        _of_member(),
    )

    platform: str = Field(primary_key=True, max_length=16)
    resource: str = Field(primary_key=True, max_length=255)
    course: str = Field(max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    sha256: str = Field(default="", max_length=SHA256_LENGTH)
    sent_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    not_before: datetime = Field(sa_column=instant_column())
    tries: int = 0
    trouble: str = Field(default="", sa_column=text_column())


class UsedMessageRow(_Row, table=True):
    """A platform's message that let somebody in, which must not do so again."""

    sha256: str = Field(primary_key=True, max_length=SHA256_LENGTH)
    expires_at: datetime = Field(sa_column=instant_column())


class WebhookRow(_Row, table=True):
    """The bot of a group chat of a course. `address` and `secret` are shown to nobody."""

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    outlet: str = Field(primary_key=True, max_length=16)
    vendor: str = Field(max_length=16)
    address: str = Field(max_length=1000)
    secret: str = Field(max_length=200)
    changed_at: datetime = Field(sa_column=instant_column())


class MailWishesRow(_Row, table=True):
    """What a course has e-mailed."""

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    due: bool
    graded: bool
    faults: bool
    changed_at: datetime = Field(sa_column=instant_column())


class NoticeRow(_Row, table=True):
    """A notice that is to be sent, or was. `person`: who gets it; empty: a group."""

    __table_args__ = (Index("notice_course", "course", "made_at"),)

    id: str = Field(primary_key=True, max_length=32)
    course: str = Field(foreign_key="course.id", max_length=64)
    outlet: str = Field(max_length=16)
    kind: str = Field(max_length=16)
    person: str = Field(default="", max_length=64)
    heading: str = Field(sa_column=text_column())
    body: str = Field(sa_column=text_column())
    made_at: datetime = Field(sa_column=instant_column())
    until: datetime = Field(sa_column=instant_column())
    not_before: datetime = Field(sa_column=instant_column())
    sent_at: datetime | None = Field(default=None, sa_column=instant_column(nullable=True))
    tries: int = 0
    code: str = Field(default="", max_length=16)
    trouble: str = Field(default="", sa_column=text_column())


class ToldRow(_Row, table=True):
    """Of which state of something the latest notice about it told. `person`: as of the notice."""

    course: str = Field(primary_key=True, foreign_key="course.id", max_length=64)
    outlet: str = Field(primary_key=True, max_length=16)
    person: str = Field(primary_key=True, max_length=64)
    about: str = Field(primary_key=True, max_length=128)
    state: str = Field(max_length=SHA256_LENGTH)


class DraftRow(_Row, table=True):
    """What a member of a course was last writing for an assignment."""

    __table_args__ = (_of_member(),)

    course: str = Field(primary_key=True, max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    text: str = Field(sa_column=text_column())
    saved_at: datetime = Field(sa_column=instant_column())


class TeamMemberRow(_Row, table=True):
    """Somebody in a team for an assignment. `team`: its code. `by_staff`: staff formed it."""

    __table_args__ = (_of_member(), Index("team_members", "course", "assignment", "team"))

    course: str = Field(primary_key=True, max_length=64)
    assignment: str = Field(primary_key=True, max_length=64)
    person: str = Field(primary_key=True, max_length=64)
    team: str = Field(max_length=16)
    by_staff: bool


OF_MEMBERS: Final = (
    TeamMemberRow,
    DraftRow,
    NoticeRow,
    ToldRow,
    PlatformScoreRow,
    IdentityRow,
    TokenRow,
    RefusedUploadRow,
    ExtensionRow,
    SectionRow,
    MemberRow,
)
"""Whose rows go when somebody is no member any more, in an order that foreign keys allow."""


def as_contract(row: SQLModel, contract: type[_Contract], **others: Any) -> _Contract:
    """Return the contract whose fields are the columns of the same names; `others` are the fields that differ."""
    same = (field.name for field in fields(contract) if field.name not in others)  # type: ignore[arg-type]
    return contract(**{name: getattr(row, name) for name in same}, **others)


def submission_of(row: SubmissionRow) -> Submission:
    """Return what a row says of a submission."""
    return as_contract(
        row,
        Submission,
        sha256=row.source_sha256,
        state=SubmissionState(row.state),
        verdict=None if row.verdict is None else GradeStatus(row.verdict),
    )


def table_of(row: type[SQLModel]) -> Table:
    """Return the table of a kind of rows, for statements that need no objects of rows."""
    table: Table = row.__table__  # type: ignore[attr-defined]
    return table
