"""Values of a type: those that are given, and those that texts are read as, by the rules of YAML."""

from __future__ import annotations

from importlib import import_module

from launch._evaluation import LaunchContext, Substitution, perform
from launch.utilities import ensure_argument_type, normalize_to_list_of_substitutions

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

ScalarTypesTuple = (int, float, bool, str)


def yaml() -> Any:
    """Return the module yaml, which is loaded where a launch file needs it only."""
    return import_module("yaml")


def extract_type(data_type: Any) -> tuple[Any, bool]:
    """Return the type of a scalar, or of a list's elements, and whether it is a list's.

    Raises ValueError: it is neither.
    """
    elements: Any = getattr(data_type, "__args__", ())
    is_list = getattr(data_type, "__origin__", None) is list and bool(elements)
    scalar = elements[0] if is_list else data_type
    if scalar not in ScalarTypesTuple:
        raise ValueError(f"Unrecognized data type: {data_type}")
    return scalar, is_list


def is_instance_of(value: Any, data_type: Any = None) -> bool:
    """Return whether a value is of a type; None: whether it is a scalar or a list of one kind of them."""
    if data_type is not None:
        scalar, is_list = extract_type(data_type)
        if not is_list:
            return isinstance(value, scalar)
        return isinstance(value, list) and all(isinstance(element, scalar) for element in value)
    if not isinstance(value, list):
        return isinstance(value, ScalarTypesTuple)
    kind = next((type(element) for element in value if type(element) is not str), str)
    return kind in ScalarTypesTuple and all(isinstance(element, kind) for element in value)


def coerce_to_type(value: str, data_type: Any = None) -> Any:
    """Return what a text is as a value of a type; None: as YAML says.

    Raises ValueError: it is none of that type. TypeError: it is no text.
    """
    ensure_argument_type(value, str, "value", "coerce_to_type")
    if data_type is None:
        return _as_yaml(value, f"Failed to convert '{value}' using yaml rules")
    scalar, is_list = extract_type(data_type)
    if is_list:
        failure = f"Cannot convert value '{value}' to a list of '{scalar}'"
        value_read = _as_yaml(value, failure)
        if not isinstance(value_read, list):
            raise ValueError(failure)
        if not all(isinstance(element, scalar) for element in value_read):
            raise ValueError(f"{failure}, got {value_read}")
        return value_read
    if scalar is not bool:
        return scalar(value)
    value_read = _as_yaml(value, f"Failed to convert '{value}' to '{bool}'")
    if not isinstance(value_read, bool):
        raise ValueError(f"Cannot convert value '{value}' to '{bool}'")
    return value_read


def _as_yaml(text: str, failure: str) -> Any:
    if not text:
        return text
    try:
        content = yaml().safe_load(text)
    except Exception as error:
        raise ValueError(f"{failure}: yaml.safe_load() failed\n{error}") from error
    if not is_instance_of(content):
        raise ValueError(f"{failure}: output type is not allowed, got {type(content)}")
    return content


def is_substitution(x: Any) -> bool:
    """Return whether it is a substitution, or a list of texts with one in it."""
    if isinstance(x, Substitution):
        return True
    return (
        isinstance(x, (list, tuple))
        and all(isinstance(element, (Substitution, str)) for element in x)
        and any(isinstance(element, Substitution) for element in x)
    )


def normalize_typed_substitution(value: Any, data_type: Any) -> Any:
    """Return a scalar, a list of substitutions, or a list with both, for `perform_typed_substitution`.

    Raises TypeError: the value cannot become one of that type.
    """
    if isinstance(value, ScalarTypesTuple):
        if not is_instance_of(value, data_type):
            raise TypeError(f"value='{value}' is not an instance of {data_type}")
        return value
    if is_substitution(value):
        return normalize_to_list_of_substitutions(value)
    if not isinstance(value, (list, tuple)):
        raise TypeError(
            "value should be either a scalar, a substitutions, or a mixed list of scalars and substitutions. "
            f"Got `value={value}` of type `{type(value)}`. "
        )
    if not all(isinstance(element, ScalarTypesTuple) or is_substitution(element) for element in value):
        raise TypeError(
            "value is a list, and one of the items is not a scalar, a Substitution "
            f"or a list of substitutions. Got value='{value}'"
        )
    scalar, is_list = (None, True) if data_type is None else extract_type(data_type)
    if not is_list:
        raise TypeError(
            "The provided value resolves to a list, though the required type is a scalar. "
            f"Got value='{value}', data_type='{scalar}'."
        )
    kind = _kind_of_scalars(value, scalar)
    return [
        normalize_to_list_of_substitutions(element) if is_substitution(element) else kind(element)
        for element in value
    ]


def _kind_of_scalars(value: Any, wanted: Any) -> Any:
    """Return the type that all scalars of a list have, or can have as `wanted`."""
    kinds = {type(element) for element in value if isinstance(element, ScalarTypesTuple)}
    if kinds == {int, float} or (kinds == {int} and wanted is float):
        kinds = {float}
    if len(kinds) > 1:
        raise TypeError(f"Input value is not an acceptable 'SomeValueType'.Got value='{value}'")
    kind = next(iter(kinds), wanted)
    if wanted not in (None, kind):
        raise TypeError(f"Got a list of '{kind}', expected a list of '{wanted}'. value='{value}'")
    return kind


def perform_typed_substitution(context: LaunchContext, value: Any, data_type: Any) -> Any:
    """Return a value that `normalize_typed_substitution` has prepared, its texts read as the type says.

    Raises:
        ValueError, TypeError: a text, or the value itself, is none of that type.
    """
    if isinstance(value, ScalarTypesTuple):
        if not is_instance_of(value, data_type):
            raise TypeError(f"value=`{value}` is a scalar and not an instance of `{data_type}`")
        return value
    if value and all(isinstance(element, Substitution) for element in value):
        return coerce_to_type(perform(context, value), data_type)
    scalar = None if data_type is None else extract_type(data_type)[0]
    found = [
        coerce_to_type(perform(context, element), scalar) if isinstance(element, list) else element
        for element in value
    ]
    if not is_instance_of(found, data_type):
        raise ValueError(
            "The output list is not uniform"
            if scalar is None
            else "The output list does not match the expected type "
            f"Got value='{value}', expected type {scalar}."
        )
    return found
