"""Assistants may pass an appeal on to the instructors."""

import sqlalchemy as sa
from alembic import op

revision = "0023"
down_revision = "0022"


def upgrade() -> None:
    """Add the columns; nobody has passed an appeal on."""
    op.add_column("appeal", sa.Column("passed_on_by", sa.String(64), nullable=False, server_default=""))
    op.add_column("appeal", sa.Column("note", sa.Text(), nullable=False, server_default=""))
