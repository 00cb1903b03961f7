"""The release of ROS 2 of a course."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the column; courses that are there go on with Humble."""
    op.add_column("course", sa.Column("distro", sa.String(32), nullable=False, server_default="humble"))
