"""The oldest tables that can be upgraded. New ones are like them, so nothing is to be done."""

revision = "0017"
down_revision = None


def upgrade() -> None:
    """Change nothing."""
