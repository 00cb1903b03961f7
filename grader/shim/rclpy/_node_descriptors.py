"""The part of `rclpy.node.Node` that is about the descriptors of parameters."""

from __future__ import annotations

from rclpy._parameter_rules import check_descriptor
from rclpy.exceptions import (
    InvalidParameterValueException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
)
from rclpy.parameter import Parameter

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class DescriptorMixin:
    """Holds the declared parameters with their descriptors."""

    def __init__(self) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, Any] = {}
        self._allow_undeclared_parameters = False

    def _apply_descriptor(
        self, parameter: Parameter, descriptor: Any = None, check_read_only: bool = True
    ) -> Any:
        if descriptor is None:
            descriptor = self.describe_parameter(parameter.name)
        return check_descriptor(parameter, descriptor, self._parameters, check_read_only)

    def describe_parameter(self, name: str) -> Any:
        """Return a parameter's ParameterDescriptor; ParameterNotDeclaredException."""
        if name in self._descriptors:
            return self._descriptors[name]
        if not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(name)
        from rclpy._interfaces import ParameterDescriptor

        return ParameterDescriptor()

    def describe_parameters(self, names: list[str]) -> list[Any]:
        """Return the descriptors of parameters; see `describe_parameter`."""
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Give a parameter another descriptor and return its ParameterValue.

        Raises:
            ParameterNotDeclaredException: it is not declared. ParameterImmutableException: it is read-only.
            InvalidParameterValueException: neither its value nor the alternative fits.
        """
        if name not in self._parameters:
            if not self._allow_undeclared_parameters:
                raise ParameterNotDeclaredException(name)
            return self._value_message(name)
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        candidates = [self._parameters[name]]
        if alternative_value is not None:
            from rclpy._interfaces import Parameter as ParameterMsg

            message = ParameterMsg(name=name, value=alternative_value)
            candidates.append(Parameter.from_parameter_msg(message))
        for candidate in candidates:
            result = self._apply_descriptor(candidate, descriptor, False)
            if result.successful:
                self._parameters[name] = candidate
                self._descriptors[name] = descriptor
                return self._value_message(name)
        raise InvalidParameterValueException(name, candidates[-1].value, result.reason)

    def _value_message(self, name: str) -> Any:
        parameter = self._parameters.get(name) or Parameter(name, Parameter.Type.NOT_SET)
        return parameter.get_parameter_value()
