"""What the models of ``assignment.yaml`` share: strictness, lengths, and numbers that may be drawn by seed."""

from random import Random
from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, field_validator

from grader.catalog.misfits import NUMBER, RANGE, MisfitError


class SpecModel(BaseModel):
    """A part of the file: unknown fields, infinite numbers, and true and false for numbers are refused."""

    model_config = ConfigDict(extra="forbid", strict=False, allow_inf_nan=False, frozen=True)

    @field_validator("*", mode="before")
    @classmethod
    def _no_truth_for_numbers(cls, value: object, info: ValidationInfo) -> object:
        """Refuse ``yes``, ``on`` and ``true`` where a number is wanted; pydantic would take them for 1."""
        if _has_truth(value):
            field = cls.model_fields[info.field_name or ""]
            if _leaves(field.annotation) <= {int, float, type(None), ...}:
                raise MisfitError(NUMBER)
        return value


def _has_truth(value: object) -> bool:
    """Whether a value is true or false, or a list, of lists, that holds one.

    Each list is looked at once: aliases let a few lines of YAML stand for any number of them.
    """
    pending, visited = [value], set[int]()
    while pending:
        one = pending.pop()
        if isinstance(one, bool):
            return True
        if isinstance(one, list) and id(one) not in visited:
            visited.add(id(one))
            pending.extend(one)
    return False


def _leaves(annotation: Any) -> set[Any]:
    """Return the plain types in an annotation such as ``tuple[float, float] | None``."""
    inner = get_args(annotation)
    if get_origin(annotation) is Annotated:
        inner = inner[:1]  # what follows are rules
    return set().union(*map(_leaves, inner)) if inner else {annotation}


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
