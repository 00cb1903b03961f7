"""A course says how long its members stay signed in."""

import sqlalchemy as sa
from alembic import op

revision = "0025"
down_revision = "0024"


def upgrade() -> None:
    """Add the column; in courses that there are, sessions are as long as before."""
    op.add_column("course", sa.Column("session_hours", sa.Integer(), nullable=False, server_default="12"))
