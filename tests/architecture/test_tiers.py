"""Which tests are everyday tests."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from tests.tiers import everyday_tests, spread


@dataclass(eq=False)
class Row:
    """What `tests.tiers` asks of a collected test."""

    name: str
    marks: Sequence[pytest.MarkDecorator] = ()
    params: dict[str, Any] = field(default_factory=dict)
    path: Path = Path("test_a.py")

    @property
    def nodeid(self) -> str:
        return f"{self.path}::{self.name}[{self.params}]"

    @property
    def callspec(self) -> "Row":
        return self

    def get_closest_marker(self, name: str) -> pytest.Mark | None:
        return next((each.mark for each in self.marks if each.name == name), None)


def chosen(rows: list[Row]) -> list[Row]:
    found: set[Any] = everyday_tests(rows)  # type: ignore[arg-type]
    return [row for row in rows if row in found]


@pytest.mark.parametrize(
    ("number", "keep", "rows"),
    [(5, 9, [0, 1, 2, 3, 4]), (9, 1, [0]), (9, 2, [0, 8]), (9, 3, [0, 4, 8]), (10, 4, [0, 3, 6, 9])],
)
def test_rows_are_spread_from_the_first_to_the_last(number: int, keep: int, rows: list[int]) -> None:
    assert spread(number, keep) == rows


def test_a_test_without_a_mark_is_an_everyday_test() -> None:
    rows = [Row("test_a", params={"x": number}) for number in range(99)]
    assert chosen(rows) == rows


def test_thorough_rows_are_not_and_count_in_no_sweep() -> None:
    marks = [pytest.mark.sweep(2)]
    rows = [Row("test_a", marks, {"x": number}) for number in range(5)]
    rows.append(Row("test_a", [*marks, pytest.mark.thorough], {"x": 5}))
    assert [row.params["x"] for row in chosen(rows)] == [0, 4]


def test_each_combination_of_the_other_parameters_takes_the_next_value() -> None:
    marks = [pytest.mark.in_turn("language")]
    rows = [
        Row("test_a", marks, {"page": page, "language": language})
        for page in ("one", "two", "three")
        for language in ("zh", "en")
    ]
    taken = [(row.params["page"], row.params["language"]) for row in chosen(rows)]
    assert taken == [("one", "zh"), ("two", "en"), ("three", "zh")]


def test_databases_are_in_turn_from_test_to_test_of_a_module() -> None:
    rows = [
        Row(name, params={"database_url": kind}, path=Path(path))
        for path in ("test_a.py", "test_b.py")
        for name in ("test_a", "test_b")
        for kind in ("sqlite", "postgresql")
    ]
    assert [row.params["database_url"] for row in chosen(rows)] == ["sqlite", "postgresql"] * 2
