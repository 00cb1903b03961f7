"""What the models of ``assignment.yaml`` share: strictness, lengths, and numbers that may be drawn by seed."""

from random import Random
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from grader.catalog.misfits import RANGE, MisfitError


class SpecModel(BaseModel):
    """A part of the file: unknown fields and infinite numbers are refused."""

    model_config = ConfigDict(extra="forbid", strict=False, allow_inf_nan=False, frozen=True)


def number_or_range(value: object) -> object:
    """Refuse what is neither a number nor a pair of least and most."""
    ends = value if isinstance(value, list | tuple) else [value, value]
    numbers = [end for end in ends if isinstance(end, int | float) and not isinstance(end, bool)]
    if len(ends) != 2 or len(numbers) != 2 or numbers[0] > numbers[1]:
        raise MisfitError(RANGE)
    return value


Metres = Annotated[float, Field(ge=-50.0, le=50.0)]
Size = Annotated[float, Field(ge=0.02, le=20.0)]
Turn = Annotated[float, Field(ge=-360.0, le=360.0)]
SpreadMetres = Annotated[Metres | tuple[Metres, Metres], BeforeValidator(number_or_range)]
SpreadSize = Annotated[Size | tuple[Size, Size], BeforeValidator(number_or_range)]
SpreadTurn = Annotated[Turn | tuple[Turn, Turn], BeforeValidator(number_or_range)]


def drawn(value: float | tuple[float, float], source: Random, decimals: int) -> float:
    """Return a value as it is, or one drawn from its range."""
    return round(source.uniform(*value), decimals) if isinstance(value, tuple) else value
