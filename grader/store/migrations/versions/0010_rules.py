"""Call the rules of assignments rules everywhere: in the table and in the audit log."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None

_AUDIT = sa.table("audit", sa.column("action", sa.String))


def _rename_action(old: str, new: str) -> None:
    op.execute(sa.update(_AUDIT).where(_AUDIT.c.action == old).values(action=new))


def upgrade() -> None:
    """Rename."""
    op.rename_table("policy", "rules")
    _rename_action("policy.change", "rules.change")


def downgrade() -> None:
    """Undo."""
    _rename_action("rules.change", "policy.change")
    op.rename_table("rules", "policy")
