"""Exceptions about parameters have one text; those about names and init take no further arguments."""

from __future__ import annotations

from rclpy import exceptions
from rclpy._jazzy.overlay import extends

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

_OF_ONE = {
    "ParameterNotDeclaredException": "Invalid access to undeclared parameter(s): {}",
    "ParameterAlreadyDeclaredException": "Parameter(s) already declared: {}",
    "InvalidParameterException": "Invalid parameter name: {}",
    "ParameterImmutableException": "Attempted to modify read-only parameter: {}",
    "ParameterUninitializedException": "The parameter '{0}' is not initialized: {0}",
}
"""Exception about one thing -> its text."""


def _worded(text: str) -> Callable[[Exception, Any], None]:
    def __init__(self: Exception, about: Any, /) -> None:  # noqa: N807 - it becomes the class's own
        Exception.__init__(self, text.format(about))

    return __init__


for _name, _text in _OF_ONE.items():
    setattr(getattr(exceptions, _name), "__init__", _worded(_text))  # noqa: B010


@extends(exceptions.NotInitializedException)
class NotInitializedException(exceptions.NotInitializedException):
    """Something is used before rclpy.init()."""

    def __init__(self, message: str | None = None) -> None:
        suffix = f" msg:{message}" if message else ""
        Exception.__init__(self, f"rclpy.init() has not been called.{suffix}")


@extends(exceptions.InvalidParameterTypeException)
class InvalidParameterTypeException(exceptions.InvalidParameterTypeException):
    """A parameter is given a value of another type than declared."""

    def __init__(self, desired_parameter: Any, expected_type: Any) -> None:
        from rclpy.parameter import Parameter

        value = desired_parameter._value
        Exception.__init__(
            self,
            f"Trying to set parameter '{desired_parameter._name}' to '{value}' of type "
            f"'{Parameter.Type.from_parameter_value(value).name}', expecting type '{expected_type}'"
            f": {desired_parameter.name}",
        )


@extends(exceptions.InvalidParameterValueException)
class InvalidParameterValueException(exceptions.InvalidParameterValueException):
    """A parameter is given a value its descriptor or a callback rejects."""

    def __init__(self, parameter: str, value: Any, reason: str) -> None:
        Exception.__init__(
            self, f"Invalid parameter value ({value}) for parameter. Reason: {reason}: {parameter}"
        )


@extends(exceptions.ROSInterruptException)
class ROSInterruptException(exceptions.ROSInterruptException):
    """A rate's sleep was interrupted by shutdown."""

    def __init__(self) -> None:
        Exception.__init__(self, "rclpy.shutdown() has been called")
