"""Exceptions about parameters have one text; those about names and init take no further arguments."""

from __future__ import annotations

from rclpy import exceptions
from rclpy._jazzy.overlay import extends

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


@extends(exceptions.NotInitializedException)
class NotInitializedException(exceptions.NotInitializedException):
    """Something is used before rclpy.init()."""

    def __init__(self, message: str | None = None) -> None:
        told = f" msg:{message}" if message else ""
        Exception.__init__(self, f"rclpy.init() has not been called.{told}")


@extends(exceptions.ParameterNotDeclaredException)
class ParameterNotDeclaredException(exceptions.ParameterNotDeclaredException):
    """A parameter is used before it is declared."""

    def __init__(self, parameters: Any) -> None:
        Exception.__init__(self, f"Invalid access to undeclared parameter(s): {parameters}")


@extends(exceptions.ParameterAlreadyDeclaredException)
class ParameterAlreadyDeclaredException(exceptions.ParameterAlreadyDeclaredException):
    """A parameter is declared twice."""

    def __init__(self, parameters: Any) -> None:
        Exception.__init__(self, f"Parameter(s) already declared: {parameters}")


@extends(exceptions.InvalidParameterException)
class InvalidParameterException(exceptions.InvalidParameterException):
    """A parameter's name is invalid."""

    def __init__(self, parameter_name: str) -> None:
        Exception.__init__(self, f"Invalid parameter name: {parameter_name}")


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


@extends(exceptions.ParameterImmutableException)
class ParameterImmutableException(exceptions.ParameterImmutableException):
    """A read-only parameter is to be changed."""

    def __init__(self, parameter_name: str) -> None:
        Exception.__init__(self, f"Attempted to modify read-only parameter: {parameter_name}")


@extends(exceptions.ParameterUninitializedException)
class ParameterUninitializedException(exceptions.ParameterUninitializedException):
    """A parameter that was declared without a value is read."""

    def __init__(self, parameter_name: str) -> None:
        Exception.__init__(self, f"The parameter '{parameter_name}' is not initialized: {parameter_name}")


@extends(exceptions.ROSInterruptException)
class ROSInterruptException(exceptions.ROSInterruptException):
    """A rate's sleep was interrupted by shutdown."""

    def __init__(self) -> None:
        Exception.__init__(self, "rclpy.shutdown() has been called")
