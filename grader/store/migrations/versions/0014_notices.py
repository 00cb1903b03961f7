"""Webhooks of group bots, what courses have e-mailed, notices, and what they told of."""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"


def upgrade() -> None:
    """Add the tables."""
    _add_settings(sa.DateTime(timezone=True))
    _add_notices(sa.DateTime(timezone=True))


def _add_settings(instant: sa.DateTime) -> None:
    op.create_table(
        "webhook",
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), primary_key=True),
        sa.Column("outlet", sa.String(16), primary_key=True),
        sa.Column("vendor", sa.String(16), nullable=False),
        sa.Column("address", sa.String(1000), nullable=False),
        sa.Column("secret", sa.String(200), nullable=False),
        sa.Column("changed_at", instant, nullable=False),
    )
    op.create_table(
        "mail_wishes",
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), primary_key=True),
        *(sa.Column(name, sa.Boolean(), nullable=False) for name in ("due", "graded", "faults")),
        sa.Column("changed_at", instant, nullable=False),
    )


def _add_notices(instant: sa.DateTime) -> None:
    op.create_table(
        "notice",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), nullable=False),
        sa.Column("outlet", sa.String(16), nullable=False),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("person", sa.String(64), nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("heading", "body")),
        *(sa.Column(name, instant, nullable=False) for name in ("made_at", "until", "not_before")),
        sa.Column("sent_at", instant, nullable=True),
        sa.Column("tries", sa.Integer(), nullable=False),
        sa.Column("code", sa.String(16), nullable=False),
        sa.Column("trouble", sa.Text(), nullable=False),
    )
    op.create_index("notice_course", "notice", ["course", "made_at"])
    op.create_table(
        "told",
        sa.Column("course", sa.String(64), sa.ForeignKey("course.id"), primary_key=True),
        sa.Column("outlet", sa.String(16), primary_key=True),
        sa.Column("person", sa.String(64), primary_key=True),
        sa.Column("about", sa.String(128), primary_key=True),
        sa.Column("state", sa.String(64), nullable=False),
    )
