"""Initial tables."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Create the tables, those referred to first."""
    _create_source()
    _create_worker()
    _create_submission()
    _create_grading()
    _create_graded_item()
    _create_graded_mistake()
    _create_trajectory()


def downgrade() -> None:
    """Undo."""
    op.drop_table("trajectory")
    op.drop_table("graded_mistake")
    op.drop_table("graded_item")
    op.drop_table("grading")
    op.drop_table("submission")
    op.drop_table("worker")
    op.drop_table("source")


def _create_source() -> None:
    op.create_table(
        "source",
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.PrimaryKeyConstraint("sha256"),
    )


def _create_worker() -> None:
    op.create_table(
        "worker",
        sa.Column("id", sa.String(length=255), nullable=False),
        sa.Column("slots", sa.Integer(), nullable=False),
        sa.Column("busy", sa.Integer(), nullable=False),
        sa.Column("sandbox_ready", sa.Boolean(), nullable=False),
        sa.Column("isolation", sa.String(length=64), nullable=False),
        sa.Column("detail", sa.Text(), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("seen_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id"),
    )


def _create_submission() -> None:
    op.create_table(
        "submission",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("student", sa.String(length=64), nullable=False),
        sa.Column("assignment", sa.String(length=64), nullable=False),
        sa.Column("file_name", sa.String(length=255), nullable=False),
        sa.Column("source_sha256", sa.String(length=64), nullable=False),
        sa.Column("size_bytes", sa.Integer(), nullable=False),
        sa.Column("state", sa.String(length=32), nullable=False),
        sa.Column("priority", sa.Integer(), nullable=False),
        sa.Column("received_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("queued_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("not_before", sa.DateTime(timezone=True), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("lease_until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("worker", sa.String(length=255), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("tries", sa.Integer(), nullable=False),
        sa.Column("trouble", sa.Text(), nullable=False),
        sa.Column("graded_attempt", sa.Integer(), nullable=True),
        sa.Column("verdict", sa.String(length=32), nullable=True),
        sa.Column("score", sa.Float(), nullable=True),
        sa.Column("max_score", sa.Float(), nullable=True),
        sa.Column("report_sha256", sa.String(length=64), nullable=True),
        sa.CheckConstraint("state != 'running' OR lease_until IS NOT NULL", name="running_has_a_lease"),
        sa.CheckConstraint(
            "state IN ('queued', 'running', 'graded', 'infrastructure_error')", name="submission_state"
        ),
        sa.ForeignKeyConstraint(
            ["source_sha256"],
            ["source.sha256"],
        ),
        sa.PrimaryKeyConstraint("id"),
    )
    op.create_index("submission_owner", "submission", ["assignment", "student", "received_at"])
    op.create_index("submission_queue", "submission", ["state", "priority", "queued_at", "id"])


def _create_grading() -> None:
    op.create_table(
        "grading",
        sa.Column("submission_id", sa.String(length=36), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("worker", sa.String(length=255), nullable=False),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("grader_version", sa.String(length=64), nullable=False),
        sa.Column("assignment_version", sa.Integer(), nullable=False),
        sa.Column("verdict", sa.String(length=32), nullable=False),
        sa.Column("score", sa.Float(), nullable=True),
        sa.Column("max_score", sa.Float(), nullable=False),
        sa.Column("report_sha256", sa.String(length=64), nullable=False),
        sa.Column("report", sa.LargeBinary(), nullable=False),
        sa.Column("measurements", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["submission_id"],
            ["submission.id"],
        ),
        sa.PrimaryKeyConstraint("submission_id", "attempt"),
    )


def _create_graded_item() -> None:
    op.create_table(
        "graded_item",
        sa.Column("submission_id", sa.String(length=36), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("item", sa.String(length=128), nullable=False),
        sa.Column("status", sa.String(length=32), nullable=False),
        sa.Column("points", sa.Float(), nullable=False),
        sa.Column("earned", sa.Float(), nullable=False),
        sa.ForeignKeyConstraint(
            ["submission_id", "attempt"],
            ["grading.submission_id", "grading.attempt"],
        ),
        sa.PrimaryKeyConstraint("submission_id", "attempt", "item"),
    )


def _create_graded_mistake() -> None:
    op.create_table(
        "graded_mistake",
        sa.Column("submission_id", sa.String(length=36), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("code", sa.String(length=64), nullable=False),
        sa.Column("rank", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["submission_id", "attempt"],
            ["grading.submission_id", "grading.attempt"],
        ),
        sa.PrimaryKeyConstraint("submission_id", "attempt", "code"),
    )


def _create_trajectory() -> None:
    op.create_table(
        "trajectory",
        sa.Column("submission_id", sa.String(length=36), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("case_id", sa.String(length=64), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(
            ["submission_id", "attempt"],
            ["grading.submission_id", "grading.attempt"],
        ),
        sa.PrimaryKeyConstraint("submission_id", "attempt", "case_id"),
    )
