"""Every kind of error that a field of ours can have is told in both languages."""

import enum
from datetime import datetime
from typing import Annotated, Any, Literal
from uuid import UUID

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from grader.contracts.text import LANGUAGES
from grader.contracts.validation_words import said


class Colour(enum.Enum):
    RED = "red"


class Everything(BaseModel):
    model_config = ConfigDict(extra="forbid")

    needed: int
    count: Annotated[int, Field(ge=1, le=9)] = 1
    pause: Annotated[int, Field(gt=0)] = 1
    share: Annotated[float, Field(allow_inf_nan=False)] = 0.0
    text: Annotated[str, Field(min_length=2, max_length=3, pattern="^[a-z]*$")] = "aa"
    chosen: Literal["a", "b"] = "a"
    colour: Colour = Colour.RED
    flag: bool = False
    at: datetime | None = None
    many: Annotated[list[int], Field(max_length=1)] = []
    inner: "Everything | None" = None
    id: UUID | None = None


@pytest.mark.parametrize(
    ("field", "value", "word"),
    [
        ("other", 1, "field"),
        ("needed", "x", "whole"),
        ("needed", 1.5, "whole"),
        ("needed", None, "whole"),
        ("needed", "9" * 5000, "whole"),
        ("count", 0, "1 or more"),
        ("count", 10, "9 or less"),
        ("pause", 0, "more than 0"),
        ("share", "x", "number"),
        ("share", None, "number"),
        ("share", "nan", "finite"),
        ("text", "a", "least is 2"),
        ("text", "aaaa", "at most 3"),
        ("text", "A!", "characters"),
        ("text", "\ud800x", "characters"),
        ("text", 1, "not text"),
        ("chosen", "c", "'a' or 'b'"),
        ("colour", "blue", "'red'"),
        ("flag", "perhaps", "true or false"),
        ("flag", [], "true or false"),
        ("at", "soon", "date and time"),
        ("at", [], "date and time"),
        ("many", 1, "list"),
        ("many", [1, 2], "at most 1"),
        ("inner", 1, "JSON object"),
        ("id", "x", "no submission's id"),
    ],
)
def test_a_known_kind_is_said_in_both_languages(field: str, value: Any, word: str) -> None:
    with pytest.raises(ValidationError) as raised:
        Everything.model_validate({"needed": 1, field: value})
    (problem,) = raised.value.errors()
    chinese, english = (said(problem, language) for language in LANGUAGES)
    assert word in english
    assert chinese.endswith("。")
    assert "{" not in chinese + english


def test_what_is_missing() -> None:
    with pytest.raises(ValidationError) as raised:
        Everything.model_validate({})
    assert said(raised.value.errors()[0], "zh") == "缺少这个字段。"


def test_an_unknown_kind_keeps_its_own_words() -> None:
    assert said({"type": "new_in_pydantic_3", "msg": "Something else"}, "zh") == "Something else"
