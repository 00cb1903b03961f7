"""Where a platform tells who is in its course."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"


def upgrade() -> None:
    """Add the column."""
    op.add_column("platform", sa.Column("people_url", sa.String(1000), nullable=False, server_default=""))
