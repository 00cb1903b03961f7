"""E-mail addresses of members, and the sections of a course."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Add the column and the table."""
    op.add_column("member", sa.Column("email", sa.String(254), nullable=False, server_default=""))
    op.create_table(
        "section",
        *(sa.Column(name, sa.String(64), primary_key=True) for name in ("course", "person", "section")),
        sa.ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"]),
    )
