"""What learning platforms ask to be chosen."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"


def upgrade() -> None:
    """Add the table."""
    op.create_table(
        "platform_picking",
        sa.Column("sha256", sa.String(64), primary_key=True),
        sa.Column("platform", sa.String(16), sa.ForeignKey("platform.id"), nullable=False),
        sa.Column("subject", sa.String(255), nullable=False),
        *(sa.Column(name, sa.Text(), nullable=False) for name in ("back", "data")),
        *(sa.Column(name, sa.Boolean(), nullable=False) for name in ("several", "scored")),
        sa.Column("until", sa.DateTime(timezone=True), nullable=False),
    )
