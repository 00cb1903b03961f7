"""The tables of the first release.

It repeats `grader.store.tables` on purpose: that module changes with every version, and a migration never does.
"""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Create the tables, those first that others refer to."""
    _create_course()
    _create_rules()
    _create_regrade()
    _create_source()
    _create_submission()
    _index_submission()
    _create_upload_key()
    _create_grading()
    _create_parts_of_a_grading()
    _create_judgement()
    _create_audit()
    _create_worker()


def _text(
    name: str, length: int, *refers_to: sa.ForeignKey, key: bool = False, empty: bool = False
) -> sa.Column[str]:
    return sa.Column(name, sa.String(length), *refers_to, primary_key=key, nullable=empty)


def _long_text(name: str) -> sa.Column[str]:
    return sa.Column(name, sa.Text(), nullable=False)


def _number(name: str, *, key: bool = False, empty: bool = False) -> sa.Column[int]:
    return sa.Column(name, sa.Integer(), primary_key=key, nullable=empty)


def _points(name: str, *, empty: bool = False) -> sa.Column[float]:
    return sa.Column(name, sa.Float(), nullable=empty)


def _instant(name: str, *, empty: bool = False) -> sa.Column[object]:
    return sa.Column(name, sa.DateTime(timezone=True), nullable=empty)


def _bytes(name: str) -> sa.Column[bytes]:
    return sa.Column(name, sa.LargeBinary(), nullable=False)


def _of_member() -> sa.ForeignKeyConstraint:
    return sa.ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"])


def _of_grading() -> sa.ForeignKeyConstraint:
    return sa.ForeignKeyConstraint(["submission_id", "attempt"], ["grading.submission_id", "grading.attempt"])


def _create_course() -> None:
    op.create_table(
        "course",
        _text("id", 64, key=True),
        _text("title", 200),
        _text("time_zone", 64),
        _instant("created_at"),
    )
    op.create_table(
        "member",
        _text("course", 64, sa.ForeignKey("course.id"), key=True),
        _text("person", 64, key=True),
        _text("name", 200),
        _text("role", 32),
        _instant("created_at"),
        sa.CheckConstraint("role IN ('student', 'assistant', 'instructor')", name="member_role"),
    )
    op.create_table(
        "token",
        _text("id", 16, key=True),
        _text("sha256", 64),
        _text("course", 64),
        _text("person", 64),
        _instant("created_at"),
        _instant("expires_at"),
        _instant("revoked_at", empty=True),
        _of_member(),
        sa.UniqueConstraint("sha256"),
    )
    op.create_index("token_owner", "token", ["course", "person"])


def _create_rules() -> None:
    op.create_table(
        "rules",
        _text("course", 64, sa.ForeignKey("course.id"), key=True),
        _text("assignment", 64, key=True),
        _long_text("document"),
        _instant("changed_at"),
    )
    op.create_table(
        "extension",
        _text("course", 64, key=True),
        _text("assignment", 64, key=True),
        _text("person", 64, key=True),
        _instant("due", empty=True),
        _number("extra_attempts"),
        _of_member(),
    )


def _create_regrade() -> None:
    op.create_table(
        "regrade",
        _text("id", 16, key=True),
        _text("course", 64, sa.ForeignKey("course.id"), empty=True),
        _text("assignment", 64),
        _text("state", 16),
        _long_text("wanted"),
        _instant("created_at"),
        _text("created_by", 64),
        _instant("decided_at", empty=True),
        _text("decided_by", 64),
        _long_text("reason"),
        _long_text("outcome"),
        sa.CheckConstraint("state IN ('open', 'applied', 'discarded')", name="regrade_state"),
    )


def _create_source() -> None:
    op.create_table("source", _text("sha256", 64, key=True), _bytes("content"))


def _create_submission() -> None:
    op.create_table(
        "submission",
        _text("id", 36, key=True),
        _text("course", 64, sa.ForeignKey("course.id"), empty=True),
        _text("student", 64),
        _text("assignment", 64),
        _text("file_name", 255),
        _text("source_sha256", 64, sa.ForeignKey("source.sha256")),
        _number("size_bytes"),
        _text("state", 32),
        _number("priority"),
        _instant("received_at"),
        _instant("queued_at"),
        _instant("turn_at"),
        _instant("not_before"),
        _instant("started_at", empty=True),
        _instant("finished_at", empty=True),
        _instant("lease_until", empty=True),
        _text("worker", 255),
        _number("attempt"),
        _number("tries"),
        _long_text("trouble"),
        _number("graded_attempt", empty=True),
        _text("verdict", 32, empty=True),
        _points("score", empty=True),
        _points("max_score", empty=True),
        _text("report_sha256", 64, empty=True),
        _text("regrade", 16, sa.ForeignKey("regrade.id"), empty=True),
        _text("original", 36, sa.ForeignKey("submission.id"), empty=True),
        _number("to_judge", empty=True),
        sa.CheckConstraint("state != 'running' OR lease_until IS NOT NULL", name="running_has_a_lease"),
        sa.CheckConstraint(
            "state IN ('queued', 'running', 'graded', 'infrastructure_error')", name="submission_state"
        ),
    )


def _index_submission() -> None:
    # the queue is ordered, and counted, by this index alone
    op.create_index("submission_queue", "submission", ["state", "priority", "turn_at", "id", "queued_at"])
    # every question about people's work names the course: among a million submissions this keeps a class quick
    op.create_index("submission_class", "submission", ["course", "student", "assignment", "received_at"])
    op.create_index("submission_finished", "submission", ["finished_at"])  # the pace of gradings
    op.create_index("submission_regrade", "submission", ["regrade"])
    # without this index and the next, each trial that is deleted is looked for in all rows that may refer to it
    op.create_index("submission_original", "submission", ["original"])


def _create_upload_key() -> None:
    op.create_table(
        "upload_key",
        _text("owner", 160, key=True),
        _text("key", 255, key=True),
        _text("digest", 64),
        _text("submission_id", 36, sa.ForeignKey("submission.id")),
        _instant("at"),
    )
    op.create_index("upload_key_submission", "upload_key", ["submission_id"])


def _create_grading() -> None:
    op.create_table("graded_assignment", _text("sha256", 64, key=True), _bytes("content"))
    op.create_table(
        "grading",
        _text("submission_id", 36, sa.ForeignKey("submission.id"), key=True),
        _number("attempt", key=True),
        _text("worker", 255),
        _instant("finished_at"),
        _text("grader_version", 64),
        _number("assignment_version"),
        _text("verdict", 32),
        _points("score", empty=True),
        _points("max_score"),
        _text("report_sha256", 64),
        _bytes("report"),
        _long_text("measurements"),
        _text("assignment_sha256", 64, sa.ForeignKey("graded_assignment.sha256"), empty=True),
        _text("regrade", 16, sa.ForeignKey("regrade.id"), empty=True),
    )


def _create_parts_of_a_grading() -> None:
    op.create_table(
        "graded_item",
        _text("submission_id", 36, key=True),
        _number("attempt", key=True),
        _text("item", 128, key=True),
        _text("status", 32),
        _points("points"),
        _points("earned"),
        _of_grading(),
    )
    op.create_table(
        "graded_mistake",
        _text("submission_id", 36, key=True),
        _number("attempt", key=True),
        _text("code", 64, key=True),
        _number("rank"),
        _of_grading(),
    )
    op.create_table(
        "trajectory",
        _text("submission_id", 36, key=True),
        _number("attempt", key=True),
        _text("case_id", 64, key=True),
        _number("position"),
        _text("sha256", 64),
        _bytes("content"),
        _of_grading(),
    )


def _create_judgement() -> None:
    op.create_table(
        "judgement",
        _text("submission_id", 36, key=True),
        _text("item", 128, key=True),
        _number("revision", key=True),
        _points("points"),
        _points("out_of"),
        _long_text("comment"),
        _text("judged_by", 64),
        _instant("judged_at"),
        _number("attempt"),
        _text("source_sha256", 64, sa.ForeignKey("source.sha256")),
        _of_grading(),
        sa.CheckConstraint("points >= 0 AND points <= out_of", name="judgement_points"),
    )


def _create_audit() -> None:
    op.create_table(
        "audit",
        _number("id", key=True),
        _instant("at"),
        _text("course", 64, empty=True),
        _text("actor", 64),
        _text("action", 64),
        _text("subject", 255),
        _long_text("before"),
        _long_text("after"),
        _long_text("reason"),
    )
    op.create_index("audit_course", "audit", ["course", "id"])


def _create_worker() -> None:
    op.create_table(
        "worker",
        _text("id", 255, key=True),
        _number("slots"),
        _number("busy"),
        sa.Column("sandbox_ready", sa.Boolean(), nullable=False),
        _text("isolation", 64),
        _long_text("detail"),
        _instant("started_at"),
        _instant("seen_at"),
    )
