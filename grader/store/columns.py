"""Column types that hold one meaning on every database, and the clock instants are taken from."""

from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Column, DateTime, Dialect, LargeBinary, Text
from sqlalchemy.types import TypeDecorator

SHA256_LENGTH = 64

Clock = Callable[[], datetime]
"""Returns the current instant as an aware datetime in UTC."""


def utc_now() -> datetime:
    """Return the current instant. Rows carry instants; gradings never see one."""
    return datetime.now(UTC)


class UtcDateTime(TypeDecorator[datetime]):
    """An aware UTC instant to the microsecond; a naive one is refused, not guessed at.

    SQLite keeps it as text of fixed width, so that comparing text compares instants.
    """

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Convert to UTC before storing."""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError(f"an instant needs a time zone: {value!r}")
        utc = value.astimezone(UTC)
        return utc.replace(tzinfo=None) if dialect.name == "sqlite" else utc

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Give back an aware instant."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)

    def coerce_compared_value(self, op: Any, value: Any) -> "UtcDateTime":
        """Compare with instants by the same rules as they are stored by."""
        return self


class PlainText(TypeDecorator[str]):
    """Text without the character NUL, which PostgreSQL cannot hold; it becomes U+FFFD."""

    impl = Text
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Dialect) -> str | None:
        """Replace before storing."""
        return None if value is None else value.replace("\0", "\ufffd")

    def process_result_value(self, value: str | None, dialect: Dialect) -> str | None:
        """Replace what a SQLite database may hold from before."""
        return None if value is None else value.replace("\0", "\ufffd")


def instant_column(*, nullable: bool = False) -> Column[datetime]:
    """Return a column of instants."""
    return Column(UtcDateTime(), nullable=nullable)


def text_column() -> Column[str]:
    """Return a column of text of any length."""
    return Column(PlainText(), nullable=False)


def bytes_column() -> Column[bytes]:
    """Return a column of bytes."""
    return Column(LargeBinary(), nullable=False)
