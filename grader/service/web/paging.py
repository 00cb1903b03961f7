"""Lists too long for one page: which page of one is asked for, and what stands on it."""

import math
from collections.abc import Sequence
from typing import TypeVar
from urllib.parse import urlencode

from pydantic import BaseModel, ConfigDict, Field

from grader.service.web.access import QueryWhole

_LINES = 100  # of a page
_Item = TypeVar("_Item")
_Query = TypeVar("_Query", bound="PageQuery")


class PageQuery(BaseModel):
    """The page that is asked for. A list that can be narrowed adds by what."""

    model_config = ConfigDict(frozen=True)

    page: QueryWhole = Field(default=1, ge=1, le=100_000)

    def address(self, **changes: object) -> str:
        """Return the query string of this view with some fields changed."""
        fields = {**self.model_dump(), **changes}
        plain = {name: int(value) if isinstance(value, bool) else value for name, value in fields.items()}
        return f"?{urlencode(plain)}"


def pages_of(count: int, size: int) -> int:
    """Return how many pages `count` lines take, at least one."""
    return max(1, math.ceil(count / size))


def cut(lines: Sequence[_Item], query: _Query) -> tuple[Sequence[_Item], _Query, int]:
    """Return the lines of the page asked for, beyond the last page the last; that page; and how many there are."""
    pages = pages_of(len(lines), _LINES)
    page = min(query.page, pages)
    return lines[(page - 1) * _LINES : page * _LINES], query.model_copy(update={"page": page}), pages
