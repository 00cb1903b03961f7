"""Assignments as everything else reads them."""

import pytest

from grader.catalog import Catalog


@pytest.mark.parametrize(
    ("assignment", "item", "title"),
    [
        ("square", "angles", "Corner angles"),
        ("square_input", "side_0_8/angles", "Corner angles (Input 0.8)"),
        ("square_input", "gone/angles", "Corner angles (gone)"),
        ("square", "dropped", "dropped"),
    ],
)
def test_an_item_of_a_report_has_a_title(assignment: str, item: str, title: str) -> None:
    assert Catalog().get(assignment).item_title(item, "en") == title
