"""Turns in the queue, and keys under which uploads are sent again."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

_CONSTANT = "1970-01-01 00:00:00.000000"


def upgrade() -> None:
    """Give every submission its turn, which so far was the instant of queueing."""
    on_sqlite = op.get_bind().dialect.name == "sqlite"
    # SQLite adds a column that may not be empty only with a constant; every row gets its own below
    constant = f"DEFAULT '{_CONSTANT}{'' if on_sqlite else '+00'}' NOT NULL"
    kind = "DATETIME" if on_sqlite else "TIMESTAMP WITH TIME ZONE"
    op.execute(f"ALTER TABLE submission ADD COLUMN turn_at {kind} {constant}")
    op.execute("UPDATE submission SET turn_at = queued_at")
    if not on_sqlite:  # which cannot take it back
        op.execute("ALTER TABLE submission ALTER COLUMN turn_at DROP DEFAULT")
    op.drop_index("submission_queue", "submission")
    op.create_index("submission_queue", "submission", ["state", "priority", "turn_at", "id"])
    op.create_table(
        "upload_key",
        sa.Column("owner", sa.String(length=160), nullable=False),
        sa.Column("key", sa.String(length=255), nullable=False),
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("submission_id", sa.String(length=36), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["submission_id"], ["submission.id"]),
        sa.PrimaryKeyConstraint("owner", "key"),
    )


def downgrade() -> None:
    """Undo."""
    op.drop_table("upload_key")
    op.drop_index("submission_queue", "submission")
    op.create_index("submission_queue", "submission", ["state", "priority", "queued_at", "id"])
    op.execute("ALTER TABLE submission DROP COLUMN turn_at")
