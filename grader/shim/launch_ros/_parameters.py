"""What `parameters=` and `SetParameter` take: prepared when the action is made, read when it is executed."""

from __future__ import annotations

from launch._evaluation import LaunchContext, Substitution, perform
from launch._types import yaml
from launch.substitutions import TextSubstitution
from launch.utilities import ensure_argument_type, normalize_to_list_of_substitutions

from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_ALLOWED = "Expected a non-empty sequence, with items of uniform type. "
_ALLOWED += "Allowed sequence item types are bool, int, float, str."
_WRAP = (
    "If the parameter is meant to be a string, try wrapping it in "
    "launch_ros.parameter_descriptions.ParameterValue(value, value_type=str)"
)


def normalize_parameters(given: Any) -> list[Any]:
    """Return the elements of `parameters=`: dictionaries of prepared values, Parameters and ParameterFiles.

    Raises TypeError: one of them is something else.
    """
    return [
        normalize_parameter_dict(entry)
        if isinstance(entry, dict)
        else entry
        if isinstance(entry, (Parameter, ParameterFile))
        else ParameterFile(entry)
        for entry in given
    ]


def normalize_parameter_dict(
    given: dict[Any, Any], before: tuple[Substitution, ...] = ()
) -> dict[tuple[Substitution, ...], Any]:
    """Return the prepared values of a dictionary by their names; those of one in it with its name in front.

    Raises TypeError: a value can be none of a parameter.
    """
    flat: dict[tuple[Substitution, ...], Any] = {}
    for key, value in given.items():
        name = (*before, *normalize_to_list_of_substitutions(key))
        if isinstance(value, dict):
            flat |= normalize_parameter_dict(value, (*name, TextSubstitution(text=".")))
        elif isinstance(value, str):
            flat[name] = (TextSubstitution(text=yaml().dump(value)),)
        elif isinstance(value, Substitution):
            flat[name] = (value,)
        elif isinstance(value, (ParameterValue, float, bool, int, bytes)):
            flat[name] = value
        elif isinstance(value, (list, tuple)):
            flat[name] = _normalized_list(value)
        else:
            raise TypeError(f"Unexpected type for parameter value {value!r}")
    return flat


def _normalized_list(value: Any) -> tuple[Any, ...]:
    """Return numbers of one type, substitutions that make one text, or a list of these for each text."""
    for element in value:
        ensure_argument_type(element, (float, int, str, bool, str, Substitution, list, tuple), "subvalue")
    kinds = {Substitution if isinstance(element, Substitution) else type(element) for element in value}
    if kinds == {int, float}:
        return tuple(float(element) for element in value)
    if kinds in ({int}, {float}, {bool}):
        return tuple(value)
    if Substitution in kinds and kinds <= {str, Substitution}:
        return tuple(normalize_to_list_of_substitutions(value))
    return tuple(
        tuple(
            normalize_to_list_of_substitutions(
                yaml().dump(element) if isinstance(element, (float, int, str)) else element
            )
        )
        for element in value
    )


def evaluate_parameter_dict(context: LaunchContext, given: dict[Any, Any]) -> dict[str, Any]:
    """Return the values of a prepared dictionary by name.

    Raises TypeError: the text of one is no YAML, or neither a scalar nor a list of one kind.
    """
    values = {}
    for key, value in given.items():
        name = perform(context, key)
        evaluated = _evaluated(context, name, value)
        values[name] = list(evaluated) if isinstance(evaluated, tuple) else evaluated
    return values


def _evaluated(context: LaunchContext, name: str, value: Any) -> Any:
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if not isinstance(value, tuple):
        return value
    if not value:
        ensure_argument_type(value, (float, int, str, bool, bytes), "value")
    if isinstance(value[0], Substitution):
        return _read(name, perform(context, value))
    if isinstance(value[0], tuple):
        return _uniform([yaml().safe_load(perform(context, element)) for element in value])
    return value


def _read(name: str, text: str) -> Any:
    try:
        value = yaml().safe_load(text or "''")
    except yaml().YAMLError:
        raise TypeError(f"Unable to parse the value of parameter {name} as yaml. {_WRAP}") from None
    if type(value) in (bool, int, float, str, bytes):
        return value
    if isinstance(value, list):
        return _uniform(value)
    raise TypeError(
        "Allowed value types are bytes, bool, int, float, str, Sequence[bool], Sequence[int], "
        f"Sequence[float], Sequence[str]. Got {type(value)}.{_WRAP}"
    )


def _uniform(value: list[Any]) -> list[Any]:
    if (
        not value
        or type(value[0]) not in (bool, int, float, str)
        or not all(isinstance(element, type(value[0])) for element in value)
    ):
        raise TypeError(_ALLOWED)
    return value
