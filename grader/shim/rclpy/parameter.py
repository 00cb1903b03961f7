"""Parameters: a name, a type and a value."""

from __future__ import annotations

import array
from enum import Enum

from rclpy._forwarding import passed_on

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any

__getattr__ = passed_on(__name__)

PARAMETER_SEPARATOR_STRING = "."

_FIELDS = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
"""Number of a type (rcl_interfaces/msg/ParameterType) -> field of ParameterValue that holds it."""

_SCALARS = {1: bool, 2: int, 3: float, 4: str}
_ELEMENTS = {5: bytes, 6: bool, 7: int, 8: float, 9: str}


def _all(values: Iterable[Any], kind: type) -> bool:
    return all(isinstance(value, kind) for value in values)


class Parameter:
    """A parameter of a node.

    Raises:
        TypeError: `type_` is no Parameter.Type, or the value's type is none of the allowed ones.
        ValueError: type and value do not agree.
    """

    class Type(Enum):
        """Types of parameters."""

        NOT_SET = 0
        BOOL = 1
        INTEGER = 2
        DOUBLE = 3
        STRING = 4
        BYTE_ARRAY = 5
        BOOL_ARRAY = 6
        INTEGER_ARRAY = 7
        DOUBLE_ARRAY = 8
        STRING_ARRAY = 9

        @classmethod
        def from_parameter_value(cls, parameter_value: Any) -> Parameter.Type:
            """Return the type of a Python value; TypeError when it has none."""
            if parameter_value is None:
                return Parameter.Type.NOT_SET
            for number, kind in _SCALARS.items():
                if isinstance(parameter_value, kind):
                    return cls(number)
            if not isinstance(parameter_value, (list, tuple, array.array)):
                raise TypeError(f"The given value is not one of the allowed types '{parameter_value}'.")
            for number, kind in _ELEMENTS.items():
                if _all(parameter_value, kind):
                    return cls(number)
            raise TypeError(f"The given value is not a list of one of the allowed types '{parameter_value}'.")

        def check(self, parameter_value: Any) -> bool:
            """Whether a value has this type."""
            number = self.value
            if number == 0:
                return parameter_value is None
            if number in _SCALARS:
                return isinstance(parameter_value, _SCALARS[number])
            sequences = (list, tuple, array.array) if number in (7, 8) else (list, tuple)
            if not isinstance(parameter_value, sequences) or not _all(parameter_value, _ELEMENTS[number]):
                return False
            return number != 5 or all(len(value) == 1 for value in parameter_value)

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> Parameter:
        """Return the parameter an rcl_interfaces/msg/Parameter holds."""
        type_ = Parameter.Type(value=param_msg.value.type)
        field = _FIELDS.get(type_.value)
        return cls(param_msg.name, type_, None if field is None else getattr(param_msg.value, field))

    def __init__(self, name: str, type_: Parameter.Type | None = None, value: Any = None) -> None:
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._type_ = type_
        self._name = name
        self._value = value

    @property
    def name(self) -> str:
        return self._name

    @property
    def type_(self) -> Parameter.Type:
        return self._type_

    @property
    def value(self) -> Any:
        return self._value

    def get_parameter_value(self) -> Any:
        """Return the value as rcl_interfaces/msg/ParameterValue."""
        from rclpy._interfaces.own import ParameterValue

        message = ParameterValue(type=self._type_.value)
        field = _FIELDS.get(self._type_.value)
        if field is not None:
            setattr(message, field, self._value)
        return message

    def to_parameter_msg(self) -> Any:
        """Return the parameter as rcl_interfaces/msg/Parameter."""
        from rclpy._interfaces.own import Parameter as ParameterMsg

        return ParameterMsg(name=self._name, value=self.get_parameter_value())


def parameter_value_to_python(parameter_value: Any) -> Any:
    """Return the Python value of an rcl_interfaces/msg/ParameterValue; RuntimeError for an unknown type."""
    if parameter_value.type == 0:
        return None
    field = _FIELDS.get(parameter_value.type)
    if field is None:
        raise RuntimeError(f"unexpected parameter type {parameter_value.type}")
    value = getattr(parameter_value, field)
    return list(value) if parameter_value.type in _ELEMENTS else value
