"""Points that people give."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Create the table; what gradings before left to people waits for them from now on."""
    op.create_table(
        "judgement",
        sa.Column("submission_id", sa.String(length=36), nullable=False),
        sa.Column("item", sa.String(length=128), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("points", sa.Float(), nullable=False),
        sa.Column("out_of", sa.Float(), nullable=False),
        sa.Column("comment", sa.Text(), nullable=False),
        sa.Column("judged_by", sa.String(length=64), nullable=False),
        sa.Column("judged_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("source_sha256", sa.String(length=64), nullable=False),
        sa.CheckConstraint("points >= 0 AND points <= out_of", name="judgement_points"),
        sa.ForeignKeyConstraint(["submission_id", "attempt"], ["grading.submission_id", "grading.attempt"]),
        sa.ForeignKeyConstraint(["source_sha256"], ["source.sha256"]),
        sa.PrimaryKeyConstraint("submission_id", "item", "revision"),
    )
    op.add_column("submission", sa.Column("to_judge", sa.Integer(), nullable=True))
    left = (
        "(SELECT count(*) FROM graded_item WHERE graded_item.submission_id = submission.id "
        "AND graded_item.attempt = submission.graded_attempt AND graded_item.status = 'needs_manual')"
    )
    op.execute(f"UPDATE submission SET to_judge = {left} WHERE {left} > 0")  # noqa: S608  no input in it


def downgrade() -> None:
    """Undo."""
    op.execute("ALTER TABLE submission DROP COLUMN to_judge")
    op.drop_table("judgement")
