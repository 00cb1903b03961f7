"""Learning platforms, their activities, the keys that sign what they are told, and messages that were used."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"


def upgrade() -> None:
    """Add the tables."""
    instant = sa.DateTime(timezone=True)
    op.create_table(
        "platform_key",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("secret", sa.Text(), nullable=False),
        sa.Column("created_at", instant, nullable=False),
    )
    op.create_table(
        "platform",
        sa.Column("id", sa.String(16), primary_key=True),
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), nullable=False),
        sa.Column("title", sa.String(200), nullable=False),
        *(sa.Column(name, sa.String(255), nullable=False) for name in ("issuer", "client_id", "deployment")),
        *(
            sa.Column(name, sa.String(1000), nullable=False)
            for name in ("login_url", "token_url", "keys_url")
        ),
        sa.Column("created_at", instant, nullable=False),
    )
    op.create_index("platform_client", "platform", ["issuer", "client_id", "deployment"], unique=True)
    op.create_table(
        "platform_link",
        sa.Column("platform", sa.String(16), sa.ForeignKey("platform.id"), primary_key=True),
        sa.Column("resource", sa.String(255), primary_key=True),
        sa.Column("title", sa.String(255), nullable=False),
        sa.Column("assignment", sa.String(64), nullable=False),
        sa.Column("line_item", sa.String(2000), nullable=False),
        sa.Column("used_at", instant, nullable=False),
    )
    op.create_table(
        "used_message",
        sa.Column("sha256", sa.String(64), primary_key=True),
        sa.Column("expires_at", instant, nullable=False),
    )
