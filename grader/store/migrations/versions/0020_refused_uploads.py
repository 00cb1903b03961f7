"""Uploads that were refused are kept for a while: who never gets as far as a grading may need help."""

import sqlalchemy as sa
from alembic import op

from grader.store.tables import PlainText, UtcDateTime

revision = "0020"
down_revision = "0019"


def upgrade() -> None:
    """Add the table."""
    op.create_table(
        "refused_upload",
        sa.Column("id", sa.String(16), primary_key=True),
        sa.Column("course", sa.String(64), nullable=False),
        sa.Column("person", sa.String(64), nullable=False),
        sa.Column("assignment", sa.String(64), nullable=False),
        sa.Column("at", UtcDateTime(), nullable=False),
        sa.Column("code", sa.String(32), nullable=False),
        sa.Column("file_name", PlainText(), nullable=False),
        sa.Column("line", sa.Integer(), nullable=True),
        sa.ForeignKeyConstraint(["course", "person"], ["member.course", "member.person"]),
    )
    op.create_index("refused_of_member", "refused_upload", ["course", "person", "at"])
