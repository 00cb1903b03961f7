"""Addresses by which learning platforms can be added to courses."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"


def upgrade() -> None:
    """Add the table."""
    op.create_table(
        "platform_invitation",
        sa.Column("sha256", sa.String(64), primary_key=True),
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), nullable=False),
        sa.Column("actor", sa.String(64), nullable=False),
        sa.Column("until", sa.DateTime(timezone=True), nullable=False),
    )
