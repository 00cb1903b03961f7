"""An index to find the submissions of one person that wait or were graded lately, however many there are."""

from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    """Add the index."""
    op.create_index("submission_lately", "submission", ["course", "student", "finished_at"])
