"""Since when a course is archived."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"


def upgrade() -> None:
    """Add the column."""
    op.add_column("course", sa.Column("archived_at", sa.DateTime(timezone=True), nullable=True))
