"""A course says how scripts are started."""

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"


def upgrade() -> None:
    """Add the column; in courses that there are, scripts are started as before."""
    op.add_column("course", sa.Column("runs_as", sa.String(32), nullable=False, server_default="python"))
