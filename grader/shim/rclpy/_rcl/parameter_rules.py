"""Rules a parameter's declaration and value must obey, with upstream's texts."""

from __future__ import annotations

from rclpy.parameter import Parameter
from rclpy.validate_parameter_name import validate_parameter_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

REL_TOL = 1e-6

_ONLY_NAME = (
    "when declaring parameter named '{}', declaring a parameter only providing its name is deprecated. "
    'You have to either:\n\t- Pass a name and a default value different to "PARAMETER NOT SET"'
    " (and optionally a descriptor).\n"
    "\t- Pass a name and a parameter type.\n"
    "\t- Pass a name and a descriptor with `dynamic_typing=True"
)


def named_declaration(
    index: int, entry: tuple[Any, ...], namespace: str, overrides: Mapping[str, Parameter]
) -> tuple[str, Any, Any]:
    """Return name, value and descriptor of one entry given to `declare_parameters`.

    Raises:
        TypeError, ValueError: the entry is malformed. InvalidParameterException: the name is empty.
    """
    name, second, descriptor = _taken_apart(index, entry)
    value = None
    if isinstance(second, Parameter.Type):
        _note_type(name, second, descriptor)
    else:
        value = second
        if value is not None and not descriptor.dynamic_typing:
            descriptor.type = _type_of_default(value)
    if name in overrides:
        value = overrides[name].value
    if namespace:
        name = f"{namespace}.{name}"
    validate_parameter_name(name)
    return name, value, descriptor


def _taken_apart(index: int, entry: tuple[Any, ...]) -> tuple[str, Any, Any]:
    from rclpy._interfaces.own import ParameterDescriptor

    if not 1 <= len(entry) <= 3:
        raise TypeError(
            f"Invalid parameter tuple length at index {index} in parameters list: {entry}; "
            "expecting length between 1 and 3"
        )
    name, second, descriptor = (*entry, None, None)[:3]
    if len(entry) < 3:
        descriptor = ParameterDescriptor()
    if not isinstance(name, str):
        raise TypeError(f"First element {name} at index {index} in parameters list is not a str.")
    if not isinstance(descriptor, ParameterDescriptor):
        raise TypeError(
            f"Third element {descriptor} at index {index} in parameters list is not a ParameterDescriptor."
        )
    if len(entry) == 1:
        import warnings

        warnings.warn(_ONLY_NAME.format(name), stacklevel=5)
        descriptor.dynamic_typing = True
    return name, second, descriptor


def _note_type(name: str, wanted: Parameter.Type, descriptor: Any) -> None:
    if wanted == Parameter.Type.NOT_SET:
        raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
    if descriptor.dynamic_typing is True:
        raise ValueError(
            f"When declaring parameter {{{name}}} passing a descriptor with"
            "`dynamic_typing=True` is not allowed when the parameter type is provided"
        )
    descriptor.type = wanted.value


def _type_of_default(value: Any) -> int:
    number = getattr(value, "type", None)
    if type(value).__name__ != "ParameterValue" or number is None:
        return int(Parameter.Type.from_parameter_value(value).value)
    if number == 0:
        raise ValueError(
            "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
        )
    return int(number)


def _result(reason: str = "") -> Any:
    from rclpy._interfaces.own import SetParametersResult

    return SetParametersResult(successful=not reason, reason=reason)


def check_descriptors(
    parameters: list[Parameter],
    descriptors: Mapping[str, Any],
    declared: Mapping[str, Parameter],
    check_read_only: bool,
) -> Any:
    """Return the first unsuccessful result of checking parameters against their descriptors."""
    for parameter in parameters:
        if parameter.name in descriptors:
            result = check_descriptor(parameter, descriptors[parameter.name], declared, check_read_only)
            if not result.successful:
                return result
    return _result()


def check_descriptor(
    parameter: Parameter, descriptor: Any, declared: Mapping[str, Parameter], check_read_only: bool
) -> Any:
    """Return whether a parameter fits its descriptor, completing the descriptor's name and dynamic type."""
    descriptor.name = parameter.name
    type_ = parameter.type_
    unset = type_ == Parameter.Type.NOT_SET
    if check_read_only and descriptor.read_only:
        return _result(f"Trying to set a read-only parameter: {parameter.name}.")
    if descriptor.dynamic_typing:
        descriptor.type = type_.value
    elif unset and parameter.name in declared:
        return _result("Static parameter cannot be undeclared")
    elif not unset and type_.value != descriptor.type:
        expected = Parameter.Type(descriptor.type)
        return _result(f"Wrong parameter type, expected '{expected}' got '{type_}'")
    if type_ == Parameter.Type.INTEGER and descriptor.integer_range:
        return _result(_integer_fault(parameter, descriptor.integer_range[0]))
    if type_ == Parameter.Type.DOUBLE and descriptor.floating_point_range:
        return _result(_float_fault(parameter, descriptor.floating_point_range[0]))
    return _result()


def _integer_fault(parameter: Parameter, bounds: Any) -> str:
    low, high = sorted((bounds.from_value, bounds.to_value))
    value = parameter.value
    if value in (low, high):
        return ""
    if not low < value < high:
        return f"Parameter {parameter.name} out of range. Min: {low}, Max: {high}, value: {value}"
    if bounds.step != 0 and (value - low) % bounds.step != 0:
        return (
            f"The parameter value for {parameter.name} is not a valid step. "
            f"Min: {low}, max: {high}, value: {value}, step: {bounds.step}"
        )
    return ""


def _float_fault(parameter: Parameter, bounds: Any) -> str:
    low, high = sorted((bounds.from_value, bounds.to_value))
    value = parameter.value
    if _is_close(value, low) or _is_close(value, high):
        return ""
    if not low < value < high:
        return f"Parameter {parameter.name} out of range Min: {low}, Max: {high}, value: {value}"
    if bounds.step != 0.0:
        nearest = low + round((value - low) / bounds.step) * bounds.step
        if not _is_close(nearest, value):
            return (
                f"The parameter value for {parameter.name} is not close enough to a valid step. "
                f"Min: {low}, max: {high}, value: {value}, step: {bounds.step}"
            )
    return ""


def _is_close(first: float, second: float) -> bool:
    from math import isclose

    return isclose(first, second, rel_tol=REL_TOL)
