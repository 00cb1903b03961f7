"""Indexes on what refers to submissions: without them each deleted trial is looked for in all rows."""

from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Create them."""
    op.create_index("submission_original", "submission", ["original"])
    op.create_index("upload_key_submission", "upload_key", ["submission_id"])


def downgrade() -> None:
    """Undo."""
    op.drop_index("upload_key_submission", table_name="upload_key")
    op.drop_index("submission_original", table_name="submission")
