"""Which slip explains what came in place of what is wanted."""

from typing import Any

import pytest

from grader.checks.expectations.slips import of_messages, of_values

SENT = ({"a": 3, "b": 4}, {"a": -2, "b": 9}, {"a": 5, "b": 1})
NUMBERS = ({"data": 2.0}, {"data": -4.5}, {"data": 8.0}, {"data": 1.0})


def code(wanted: list[Any], came: list[Any], sent: Any = SENT) -> str | None:
    pairs = [({**one}, {"out": w}, {"out": c}) for one, w, c in zip(sent, wanted, came, strict=True)]
    found = of_values("/name", pairs)
    return None if found is None else found.code


@pytest.mark.parametrize(
    ("wanted", "came", "slip"),
    [
        ([7, 7, 6], [-1, -11, 4], "slip_formula"),
        ([7, 7, 6], [8, 8, 7], "slip_one_more"),
        ([7.0, 8.0, 6.0], [700.0, 800.0, 600.0], "slip_factor"),
        ([7, 8, 6], [12, 13, 11], "slip_offset"),
        ([True, False, True], [False, True, False], "slip_swapped"),
        (["left", "right", "left"], ["right", "left", "right"], "slip_swapped"),
        (["sum 7", "sum 8", "sum 6"], ["sum 8", "sum 9", "sum 7"], "slip_one_more"),
        (["sum 7", "sum 8", "sum 6"], ["sum 7.0", "sum 8.0", "sum 6.0"], "slip_letters"),
        (["Sum 7", "Sum 8", "Sum 6"], ["sum7", "sum8", "sum6"], "slip_letters"),
        ([[4, 3, 2], [3, 2], [2, 1]], [[3, 2], [2], [1]], "slip_list_late"),
        ([[0, 1, 1], [0, 1], [0]], [[1, 2, 2], [1, 2], [1]], "slip_one_more"),
        ([7, 8, 6], [1, 20, -3], None),
        (["one", "two", "three"], ["1", "", "x"], None),
    ],
)
def test_a_slip_is_named_where_it_explains_every_answer(
    wanted: list[Any], came: list[Any], slip: str | None
) -> None:
    assert code(wanted, came) == slip


@pytest.mark.parametrize(
    "came", [[2.0, -2.5, 5.5, 6.5], [2.0, -1.25, 5.5 / 3, 6.5 / 4], [2.0, 2.0, 8.0, 8.0], [1, 2, 3, 4]]
)
def test_a_formula_of_all_that_was_sent_is_tried(came: list[float]) -> None:
    assert code([2.0, -4.0, 7.0, 3.0], came, NUMBERS) == "slip_formula"


def test_messages_that_answer_nothing_are_compared_as_texts_too() -> None:
    pairs = [({"n": n, "t": 0.0}, {"data": f"Hello: {n}"}, {"data": f"hello: {n}"}) for n in range(3)]
    found = of_messages("/chatter", pairs)
    assert found is not None
    assert found.code == "messages_letters"
    later = [({"n": n, "t": 0.0}, {"data": f"Hello: {n}"}, {"data": f"Hello: {n + 1}"}) for n in range(3)]
    found = of_messages("/chatter", later)
    assert found is not None
    assert found.code == "messages_off"
