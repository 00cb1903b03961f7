"""What sign-in providers call the members, and who was recognised a moment ago."""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"


def upgrade() -> None:
    """Add the tables."""
    op.create_table(
        "identity",
        sa.Column("id", sa.String(16), primary_key=True),
        sa.Column("provider", sa.String(64), nullable=False),
        sa.Column("subject", sa.String(255), nullable=False),
        sa.Column("course", sa.String(64), nullable=False),
        sa.Column("person", sa.String(64), nullable=False),
        sa.Column("bound_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("by_token", sa.Boolean(), nullable=False),
        sa.ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"]),
    )
    op.create_index("identity_subject", "identity", ["provider", "subject", "course"], unique=True)
    op.create_table(
        "recognised",
        sa.Column("sha256", sa.String(64), primary_key=True),
        sa.Column("provider", sa.String(64), nullable=False),
        sa.Column("subject", sa.String(255), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
    )
