"""Re-grades that are undone as a whole, and what students are told of re-grades."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"

_STATES = "state IN ('open', 'applied', 'discarded', 'undone')"


def upgrade() -> None:
    """Allow the state, name who undid a re-grade and what a grading replaced, add the table of what is told."""
    with op.batch_alter_table("regrade") as regrade:
        regrade.add_column(sa.Column("undone_at", sa.DateTime(timezone=True), nullable=True))
        regrade.add_column(sa.Column("undone_by", sa.String(64), nullable=False, server_default=""))
        regrade.add_column(sa.Column("undone_reason", sa.Text(), nullable=False, server_default=""))
    if op.get_bind().dialect.name == "sqlite":
        _make_anew()
    else:
        op.drop_constraint("regrade_state", "regrade", type_="check")
        op.create_check_constraint("regrade_state", "regrade", _STATES)
    op.add_column("grading", sa.Column("replaced", sa.Integer(), nullable=True))
    op.create_index("grading_regrade", "grading", ["regrade"])
    op.create_table(
        "told_change",
        sa.Column("submission_id", sa.String(36), sa.ForeignKey("submission.id"), primary_key=True),
        sa.Column("regrade", sa.String(16), sa.ForeignKey("regrade.id"), primary_key=True),
        sa.Column("undone", sa.Boolean(), primary_key=True),
        sa.Column("change", sa.Text(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("seen_at", sa.DateTime(timezone=True), nullable=True),
    )


def _make_anew() -> None:
    """Make the table again with the other constraint: SQLite changes none of a table that is there.

    Other tables refer to its rows. That is looked at when the transaction ends, and each row that is put back
    makes good for the same one that went with the table.
    """
    made = str(
        op.get_bind().exec_driver_sql("SELECT sql FROM sqlite_master WHERE name = 'regrade'").scalar_one()
    )
    op.execute("PRAGMA defer_foreign_keys = ON")
    op.execute("CREATE TEMPORARY TABLE held AS SELECT * FROM regrade")
    op.execute("DROP TABLE regrade")
    op.execute(made.replace("state IN ('open', 'applied', 'discarded')", _STATES))
    op.execute("INSERT INTO regrade SELECT * FROM held")
    op.execute("DROP TABLE held")
