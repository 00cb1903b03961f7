"""The part of `rclpy.node.Node` that is about parameters."""

from __future__ import annotations

from rclpy._node_descriptors import DescriptorMixin
from rclpy._parameter_rules import check_descriptors, named_declaration
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any

    from rclpy.publisher import Publisher

    SetCallback = Callable[[list[Parameter]], Any]

NOT_SET = Parameter.Type.NOT_SET


class ParameterMixin(DescriptorMixin):
    """Declares, reads, checks and sets the parameters of a node."""

    PARAM_REL_TOL = 1e-6
    """Relative tolerance when a float parameter is held against its range."""

    def __init__(self, allow_undeclared_parameters: bool) -> None:
        super().__init__()
        self._parameter_overrides: dict[str, Parameter] = {}
        self._parameters_callbacks: list[SetCallback] = []
        self._allow_undeclared_parameters = allow_undeclared_parameters
        self._parameter_event_publisher: Publisher | None = None

    # Declaring -----------------------------------------------------------------------------------

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """Declare a parameter and return it with its value from the command line, or else `value`.

        Raises:
            ParameterAlreadyDeclaredException: it is declared. InvalidParameterException: its name is empty.
            InvalidParameterValueException: a callback or the descriptor rejects the value.
            InvalidParameterTypeException: the command line gives it another type.
        """
        if value is None and descriptor is None:
            declaration: tuple[Any, ...] = (name,)
        elif descriptor is None:
            from rclpy._interfaces import ParameterDescriptor

            declaration = (name, value, ParameterDescriptor())
        else:
            declaration = (name, value, descriptor)
        return self.declare_parameters("", [declaration], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare parameters given as (name), (name, value or type) or (name, value, descriptor).

        Raises:
            TypeError: an entry has another form.
            ValueError: a type is given together with dynamic typing, or is NOT_SET.
        """
        wanted: list[Parameter] = []
        descriptors: dict[str, Any] = {}
        overrides = {} if ignore_override else self._parameter_overrides
        for index, entry in enumerate(parameters):
            name, value, descriptor = named_declaration(index, entry, namespace, overrides)
            wanted.append(Parameter(name, value=value))
            descriptors[name] = descriptor
        known = [parameter.name for parameter in wanted if parameter.name in self._parameters]
        if any(known):
            raise ParameterAlreadyDeclaredException(known)
        self._set_parameters(wanted, descriptors, raise_on_failure=True, allow_undeclared_parameters=True)
        return [self._parameters[parameter.name] for parameter in wanted]

    def undeclare_parameter(self, name: str) -> None:
        """Forget a parameter; ParameterNotDeclaredException, ParameterImmutableException."""
        if not self.has_parameter(name):
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name]
        del self._descriptors[name]

    # Reading -------------------------------------------------------------------------------------

    def has_parameter(self, name: str) -> bool:
        """Whether a parameter is declared."""
        return name in self._parameters

    def get_parameter_types(self, names: list[str]) -> list[Any]:
        """Return the types of parameters; see `get_parameter_type`."""
        _require_names(names)
        return [self.get_parameter_type(name) for name in names]

    def get_parameter_type(self, name: str) -> Any:
        """Return the number of a parameter's type; ParameterNotDeclaredException."""
        if self.has_parameter(name):
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Return parameters; see `get_parameter`."""
        _require_names(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; ParameterNotDeclaredException, ParameterUninitializedException."""
        if self.has_parameter(name):
            parameter = self._parameters[name]
            if parameter.type_ != NOT_SET or self._descriptors[name].dynamic_typing:
                return parameter
            raise ParameterUninitializedException(name)
        if self._allow_undeclared_parameters:
            return Parameter(name, NOT_SET, None)
        raise ParameterNotDeclaredException(name)

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative when it is not declared or has no value."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.type_ == NOT_SET:
            return Parameter(name, NOT_SET) if alternative_value is None else alternative_value
        return parameter

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters whose names begin with ``prefix.``, by the rest of their names."""
        if prefix:
            prefix = prefix + PARAMETER_SEPARATOR_STRING
        return {
            name[len(prefix) :]: parameter
            for name, parameter in self._parameters.items()
            if name.startswith(prefix)
        }

    # Setting -------------------------------------------------------------------------------------

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Set parameters one by one and return a SetParametersResult for each."""
        return self._set_parameters(parameter_list)

    def _set_parameters(
        self,
        parameter_list: list[Parameter],
        descriptors: Mapping[str, Any] | None = None,
        raise_on_failure: bool = False,
        allow_undeclared_parameters: bool = False,
    ) -> list[Any]:
        results = []
        for parameter in parameter_list:
            if not allow_undeclared_parameters:
                self._check_undeclared_parameters([parameter])
            result = self._set_parameters_atomically(
                [parameter], descriptors, allow_not_set_type=allow_undeclared_parameters
            )
            if raise_on_failure and not result.successful:
                if descriptors is not None and result.reason.startswith("Wrong parameter type"):
                    expected = Parameter.Type(descriptors[parameter.name].type).name
                    raise InvalidParameterTypeException(parameter, expected)
                raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)
            results.append(result)
        return results

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set all parameters or none and return one SetParametersResult."""
        self._check_undeclared_parameters(parameter_list)
        return self._set_parameters_atomically(parameter_list)

    def _check_undeclared_parameters(self, parameter_list: list[Parameter]) -> None:
        if not all(isinstance(parameter, Parameter) for parameter in parameter_list):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        undeclared = (p.name for p in parameter_list if p.name not in self._parameters)
        if not self._allow_undeclared_parameters and any(undeclared):
            # Upstream names what is left of the generator after `any`: usually nothing.
            raise ParameterNotDeclaredException(list(undeclared))

    def _set_parameters_atomically(
        self,
        parameter_list: list[Parameter],
        descriptors: Mapping[str, Any] | None = None,
        allow_not_set_type: bool = False,
    ) -> Any:
        """Check, ask the callbacks, store and publish the change; NOT_SET undeclares unless allowed."""
        result = check_descriptors(
            parameter_list,
            self._descriptors if descriptors is None else descriptors,
            self._parameters,
            check_read_only=descriptors is None,
        )
        if not result.successful:
            return result
        for callback in self._parameters_callbacks:
            result = callback(parameter_list)
            if not result.successful:
                return result
        event: dict[str, list[Parameter]] = {"new": [], "changed": [], "deleted": []}
        for parameter in parameter_list:
            event[self._store(parameter, descriptors, allow_not_set_type)].append(parameter)
        self._publish_parameter_event(event)
        from rclpy._interfaces import SetParametersResult

        return SetParametersResult(successful=True)

    def _store(
        self, parameter: Parameter, descriptors: Mapping[str, Any] | None, allow_not_set_type: bool
    ) -> str:
        """Store one parameter and return what happened to it."""
        name = parameter.name
        if parameter.type_ == NOT_SET and not allow_not_set_type:
            self._parameters.pop(name, None)
            self._descriptors.pop(name, None)
            return "deleted"
        if descriptors is not None:
            self._descriptors[name] = descriptors[name]
        elif name not in self._descriptors:
            from rclpy._interfaces import ParameterDescriptor

            self._descriptors[name] = ParameterDescriptor(dynamic_typing=True)
        old = self._parameters.get(name)
        self._parameters[name] = parameter
        return "new" if old is None or old.type_ == NOT_SET else "changed"

    def _publish_parameter_event(self, event: dict[str, list[Parameter]]) -> None:
        publisher = self._parameter_event_publisher
        if publisher is None or not publisher.handle.readers:
            return
        from rclpy._interfaces import ParameterEvent

        message = ParameterEvent(node=self.get_fully_qualified_name())  # type: ignore[attr-defined]
        for what, parameters in event.items():
            setattr(message, f"{what}_parameters", [parameter.to_parameter_msg() for parameter in parameters])
        message.stamp = self.get_clock().now().to_msg()  # type: ignore[attr-defined]
        publisher.publish(message)

    def add_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Have `callback` asked before parameters are set; the last added is asked first."""
        self._parameters_callbacks.insert(0, callback)

    def remove_on_set_parameters_callback(self, callback: SetCallback) -> None:
        """Undo `add_on_set_parameters_callback`; ValueError when it was not added."""
        self._parameters_callbacks.remove(callback)


def _require_names(names: list[str]) -> None:
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")
