"""Re-grades, and the assignments that were graded."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Create the tables; the new columns are empty for what is there already."""
    op.create_table(
        "graded_assignment",
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.PrimaryKeyConstraint("sha256"),
    )
    op.create_table(
        "regrade",
        sa.Column("id", sa.String(length=16), nullable=False),
        sa.Column("course", sa.String(length=64), nullable=True),
        sa.Column("assignment", sa.String(length=64), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("wanted", sa.Text(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("created_by", sa.String(length=64), nullable=False),
        sa.Column("decided_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("decided_by", sa.String(length=64), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.Column("outcome", sa.Text(), nullable=False),
        sa.CheckConstraint("state IN ('open', 'applied', 'discarded')", name="regrade_state"),
        sa.ForeignKeyConstraint(["course"], ["course.id"]),
        sa.PrimaryKeyConstraint("id"),
    )
    op.execute("ALTER TABLE submission ADD COLUMN regrade VARCHAR(16) REFERENCES regrade (id)")
    op.execute("ALTER TABLE submission ADD COLUMN original VARCHAR(36) REFERENCES submission (id)")
    op.create_index("submission_regrade", "submission", ["regrade"])
    op.execute(
        "ALTER TABLE grading ADD COLUMN assignment_sha256 VARCHAR(64) REFERENCES graded_assignment (sha256)"
    )
    op.execute("ALTER TABLE grading ADD COLUMN regrade VARCHAR(16) REFERENCES regrade (id)")


def downgrade() -> None:
    """Undo."""
    op.execute("ALTER TABLE grading DROP COLUMN regrade")
    op.execute("ALTER TABLE grading DROP COLUMN assignment_sha256")
    op.drop_index("submission_regrade", "submission")
    op.execute("ALTER TABLE submission DROP COLUMN original")
    op.execute("ALTER TABLE submission DROP COLUMN regrade")
    op.drop_table("regrade")
    op.drop_table("graded_assignment")
