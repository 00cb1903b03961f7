"""Long lists of rows for one test: `make test` takes some of them, `make test-all` all."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

import pytest
from _pytest.mark import ParameterSet

T = TypeVar("T")


def slow_but(keep: int, rows: Iterable[T]) -> list[T | ParameterSet]:
    """Return the rows, all slow but `keep` of them: the first, the last, and others spread evenly between them."""
    all_rows = list(rows)
    last = len(all_rows) - 1
    kept = {number * last // max(keep - 1, 1) for number in range(keep)}
    return [
        row if number in kept else pytest.param(row, marks=pytest.mark.slow)
        for number, row in enumerate(all_rows)
    ]
