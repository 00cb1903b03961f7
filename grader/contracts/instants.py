"""Instants in writing: ISO 8601, date and time of day, with an offset or without."""

import re
from datetime import datetime

_INSTANT = re.compile(
    r"[0-9]{4}-[0-9]{2}-[0-9]{2}[T ][0-9]{2}:[0-9]{2}(:[0-9]{2}([.][0-9]{1,9})?)?(Z|[+-][0-9]{2}:[0-9]{2})?"
)


def instant(text: str) -> datetime:
    """Return the instant that `text` writes; naive when it names no offset.

    A date alone is none: as midnight it would end a day before its reader thinks. Neither is a number, which some
    readers take for seconds since 1970.

    Raises:
        ValueError: it is anything else, or there is no such date.
    """
    upper = text.upper()
    if not _INSTANT.fullmatch(upper):
        raise ValueError("no date and time such as 2026-03-20T23:59:59")
    return datetime.fromisoformat(upper)
