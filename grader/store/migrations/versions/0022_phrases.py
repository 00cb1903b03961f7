"""Comments that staff use again, by course."""

import sqlalchemy as sa
from alembic import op

from grader.store.tables import PlainText

revision = "0022"
down_revision = "0021"


def upgrade() -> None:
    """Add the table."""
    op.create_table(
        "phrase",
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), primary_key=True),
        sa.Column("key", sa.String(16), primary_key=True),
        sa.Column("text", PlainText(), nullable=False),
    )
