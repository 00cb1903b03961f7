"""Explanations of gradings: who waits for one, and what was found."""

import sqlalchemy as sa
from alembic import op

from grader.store.tables import CompressedBytes, UtcDateTime

revision = "0021"
down_revision = "0020"


def upgrade() -> None:
    """Add the table. Gradings from before are explained when somebody looks at them."""
    op.create_table(
        "explanation",
        sa.Column("submission_id", sa.String(36), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("turn_at", UtcDateTime(), nullable=False),
        sa.Column("lease_until", UtcDateTime(), nullable=True),
        sa.Column("tries", sa.Integer(), nullable=False),
        sa.Column("took_s", sa.Float(), nullable=False),
        sa.Column("finished_at", UtcDateTime(), nullable=True),
        sa.Column("content", CompressedBytes(), nullable=True),
        sa.PrimaryKeyConstraint("submission_id", "attempt"),
        sa.ForeignKeyConstraint(["submission_id", "attempt"], ["grading.submission_id", "grading.attempt"]),
    )
    op.create_index("explanation_waiting", "explanation", ["finished_at", "turn_at"])
