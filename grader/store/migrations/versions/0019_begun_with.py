"""A course knows with which assignments it began: others are drafts until it shows them."""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"


def upgrade() -> None:
    """Add the column; courses that there are begin with their next upload."""
    op.add_column("course", sa.Column("begun_with", sa.Text(), nullable=True))
