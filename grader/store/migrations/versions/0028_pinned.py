"""What staff says to every student who makes a mistake."""

import sqlalchemy as sa
from alembic import op

from grader.store.tables import PlainText

revision = "0028"
down_revision = "0027"


def upgrade() -> None:
    """Add the table."""
    op.create_table(
        "pinned",
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), primary_key=True),
        sa.Column("assignment", sa.String(64), primary_key=True),
        sa.Column("mistake", sa.String(64), primary_key=True),
        sa.Column("text", PlainText(), nullable=False),
    )
