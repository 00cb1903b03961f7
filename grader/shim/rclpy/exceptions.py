"""Exceptions of the client library, with upstream's arguments and texts."""

from __future__ import annotations

from rclpy._rcl.errors import InvalidHandle as InvalidHandle

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class NotInitializedException(Exception):
    """Something was done before `rclpy.init`."""

    def __init__(self, *args: Any) -> None:
        super().__init__("rclpy.init() has not been called", *args)


class NoTypeSupportImportedException(Exception):
    """A message class has no type support."""

    def __init__(self, *args: Any) -> None:
        super().__init__("no type_support imported")


class NameValidationException(Exception):
    """A name is invalid; the text points at the character."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  '{name}'\n   {' ' * invalid_index}^")


class InvalidNamespaceException(NameValidationException):
    """A namespace is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidNodeNameException(NameValidationException):
    """A node name is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """A topic name is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class InvalidServiceNameException(NameValidationException):
    """A service name is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int, *args: Any) -> None:
        super().__init__("service name", name, error_msg, invalid_index)


class ParameterException(Exception):
    """Base of the errors about parameters."""

    def __init__(self, error_msg: str, parameters: Any, *args: Any) -> None:
        Exception.__init__(self, f"{error_msg}: {parameters}")


class ParameterNotDeclaredException(ParameterException):
    """A parameter is used before it is declared."""

    def __init__(self, parameters: Any, *args: Any) -> None:
        Exception.__init__(self, "Invalid access to undeclared parameter(s)", parameters, *args)


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter is declared twice."""

    def __init__(self, parameters: Any, *args: Any) -> None:
        Exception.__init__(self, "Parameter(s) already declared", parameters, *args)


class InvalidParameterException(ParameterException):
    """A parameter's name is invalid."""

    def __init__(self, parameter: Any, *args: Any) -> None:
        Exception.__init__(self, "Invalid parameter name", parameter, *args)


class InvalidParameterTypeException(ParameterException):
    """A parameter is given a value of another type than declared."""

    def __init__(self, desired_parameter: Any, expected_type: Any, *args: Any) -> None:
        from rclpy.parameter import Parameter

        value = desired_parameter._value
        Exception.__init__(
            self,
            f"Trying to set parameter '{desired_parameter._name}' to '{value}' of type "
            f"'{Parameter.Type.from_parameter_value(value).name}', expecting type '{expected_type}'",
            *args,
        )
        self._actual_type = desired_parameter.type_
        self._param_name = desired_parameter.name


class InvalidParameterValueException(ParameterException):
    """A parameter is given a value its descriptor or a callback rejects."""

    def __init__(self, parameter: Any, value: Any, reason: str, *args: Any) -> None:
        Exception.__init__(
            self, f"Invalid parameter value ({value}) for parameter. Reason: {reason}", parameter, *args
        )


class ParameterImmutableException(ParameterException):
    """A read-only parameter is to be changed."""

    def __init__(self, parameter: Any, *args: Any) -> None:
        Exception.__init__(self, "Attempted to modify read-only parameter", parameter, *args)


class ParameterUninitializedException(ParameterException):
    """A parameter that was declared without a value is read."""

    def __init__(self, parameter_name: str, *args: Any) -> None:
        Exception.__init__(self, f"The parameter '{parameter_name}' is not initialized", *args)


class ROSInterruptException(Exception):
    """A rate's sleep was interrupted by shutdown."""

    def __init__(self, *args: Any) -> None:
        Exception.__init__(self, "rclpy.shutdown() has been called", *args)
