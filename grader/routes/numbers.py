"""Numbers in requests: digits in addresses, numbers (not text, not true or false) in bodies.

Pydantic by itself also takes ``"1_0"``, ``" 10"``, ``"1e1"`` and ``true``, as Python does.
"""

from typing import Annotated

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from grader.contracts.numerals import whole


def _in_digits(value: object) -> object:
    if not isinstance(value, str):
        return value
    try:
        return whole(value)
    except ValueError:
        raise PydanticCustomError("int_parsing", "Input should be a whole number in digits") from None


def _number(value: object) -> object:
    if isinstance(value, bool | str):
        raise PydanticCustomError("float_type", "Input should be a number")
    return value


def _whole_number(value: object) -> object:
    if isinstance(value, bool | str):
        raise PydanticCustomError("int_type", "Input should be a whole number")
    return value


QueryWhole = Annotated[int, BeforeValidator(_in_digits)]
"""A whole number in the query of an address."""

Whole = Annotated[int, BeforeValidator(_whole_number)]
"""A whole number in a JSON body; 10.0 is one, as in JSON Schema."""

Number = Annotated[float, BeforeValidator(_number)]
"""A number in a JSON body. Bounds refuse what is not finite."""
