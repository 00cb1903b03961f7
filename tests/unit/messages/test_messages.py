"""Sentences with their values filled in."""

import pytest

from grader.messages import outline, sentence


@pytest.mark.parametrize(
    ("message_id", "values", "said"),
    [
        ("places.contacts.seen", {"value": "1"}, "Walls were touched 1 time."),
        ("places.contacts.seen", {"value": "0"}, "Walls were touched 0 times."),
        ("page.class.attempts", {"count": 1}, "1 attempt"),
        ("page.class.attempts", {"count": 21}, "21 attempts"),
        ("page.points", {"points": "1.5"}, "1.5 points"),
    ],
)
def test_english_tells_one_from_several(message_id: str, values: dict[str, object], said: str) -> None:
    assert sentence("en", message_id, **values) == said


def test_an_outline_says_several() -> None:
    assert outline("en", "places.contacts.seen") == "Walls were touched … times."
