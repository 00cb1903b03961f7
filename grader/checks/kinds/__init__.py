"""The kinds of checks, one module each, and the tables in which they are registered.

They do not know each other: import-linter holds every module in this folder to it. A kind is imported when it is
first asked for, because a cold start pays for every import.
"""

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import TypeVar, cast

from grader.checks.measure import Check, Kind, TextCheck

Registered = TypeVar("Registered", bound=Kind)


class _Table(Mapping[str, Registered]):
    """The checks of modules of this folder, which have the names of their kinds."""

    def __init__(self, *kinds: str) -> None:
        self._kinds = dict.fromkeys(kinds)

    def __getitem__(self, kind: str) -> Registered:
        if kind not in self._kinds:
            raise KeyError(kind)
        return cast("Registered", import_module(f"{__name__}.{kind}").CHECK)

    def __iter__(self) -> Iterator[str]:
        return iter(self._kinds)

    def __len__(self) -> int:
        return len(self._kinds)


CHECKS: Mapping[str, Check] = _Table(
    "conversation", "motion", "rotation", "polygon", "path", "places", "room", "bodies"
)
TEXT_CHECKS: Mapping[str, TextCheck] = _Table("number", "essay")
KINDS: Mapping[str, Kind] = _Table(*CHECKS, *TEXT_CHECKS)
OLDER_NAMES: Mapping[str, str] = dict.fromkeys(("node", "service", "agent"), "conversation")
"""What checks were called before, in assignments that are stored."""
