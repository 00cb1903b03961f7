"""What learning platforms were told of their members."""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    """Add the table."""
    instant = sa.DateTime(timezone=True)
    op.create_table(
        "platform_score",
        sa.Column("platform", sa.String(16), primary_key=True),
        sa.Column("resource", sa.String(255), primary_key=True),
        sa.Column("course", sa.String(64), nullable=False),
        sa.Column("person", sa.String(64), primary_key=True),
        sa.Column("sha256", sa.String(64), nullable=False),
        sa.Column("sent_at", instant, nullable=True),
        sa.Column("not_before", instant, nullable=False),
        sa.Column("tries", sa.Integer(), nullable=False),
        sa.Column("trouble", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["platform", "resource"], ["platform_link.platform", "platform_link.resource"]
        ),
        sa.ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"]),
    )
