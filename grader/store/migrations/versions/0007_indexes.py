"""Indexes that keep a class, a student's work and the pace of gradings quick among a million submissions."""

from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Begin with the course, which every question about people's work names; count the queue by index alone."""
    op.drop_index("submission_queue", table_name="submission")
    op.create_index("submission_queue", "submission", ["state", "priority", "turn_at", "id", "queued_at"])
    op.create_index("submission_class", "submission", ["course", "student", "assignment", "received_at"])
    op.create_index("submission_finished", "submission", ["finished_at"])
    op.drop_index("submission_owner", table_name="submission")


def downgrade() -> None:
    """Undo."""
    op.drop_index("submission_queue", table_name="submission")
    op.create_index("submission_queue", "submission", ["state", "priority", "turn_at", "id"])
    op.create_index("submission_owner", "submission", ["assignment", "student", "received_at"])
    op.drop_index("submission_finished", table_name="submission")
    op.drop_index("submission_class", table_name="submission")
