"""Sessions of browsers: rows of the tokens' table that name the token which opened them."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Add the column."""
    op.add_column("token", sa.Column("opened_by", sa.String(16), nullable=True))
