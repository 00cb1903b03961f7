"""Teams, and which submissions came with one upload of a team."""

import sqlalchemy as sa
from alembic import op

revision = "0026"
down_revision = "0025"


def upgrade() -> None:
    """Add the table and the column."""
    op.create_table(
        "team_member",
        sa.Column("course", sa.String(64), primary_key=True),
        sa.Column("assignment", sa.String(64), primary_key=True),
        sa.Column("person", sa.String(64), primary_key=True),
        sa.Column("team", sa.String(16), nullable=False),
        sa.Column("by_staff", sa.Boolean(), nullable=False),
        sa.ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"]),
    )
    op.create_index("team_members", "team_member", ["course", "assignment", "team"])
    op.add_column("submission", sa.Column("team_upload", sa.String(36), nullable=True))
    op.create_index("submission_team_upload", "submission", ["team_upload"])
