"""Builds message, service and action classes from their definitions."""

from __future__ import annotations

import sys
from array import array
from math import isinf
from operator import attrgetter
from struct import error as StructError  # noqa: N812 - it is a class
from struct import pack

from rclpy._interfaces.definitions import INTERFACES, SITE_PACKAGES, Field, Interface, Structure
from rclpy._interfaces.field_types import alias
from rclpy._interfaces.message_source import FLOAT_BOUND, class_source, default_source
from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

STRUCTURES: dict[type, Structure] = {}
"""The definition of every message class built so far."""

CLASSES: dict[str, type] = {}
"""The message classes built so far by their full names; a class is built after those of its fields."""


class InterfaceType(type):
    """Metaclass of all interface classes; rclpy knows a ROS 2 type by its attribute `_TYPE_SUPPORT`."""

    _TYPE_SUPPORT: object = None

    @classmethod
    def __import_type_support__(cls) -> None:
        """Pretend to load the C type support."""
        cls._TYPE_SUPPORT = cls


def interface_name(cls: type) -> str:
    """Return the full ROS name of an interface class, e.g. ``geometry_msgs/msg/Twist``."""
    package, kind, _ = cls.__module__.split(".")
    return f"{package}/{kind}/{cls.__name__}"


def class_of(msg_type: Any) -> Any:
    """Return the class of a message that was given instead of it (`Pose()`), as at home serves as well."""
    return msg_type if isinstance(msg_type, type) else type(msg_type)


def interface_class(full_name: str) -> type:
    """Return the message, service or action class of a full name, importing its module.

    Raises KeyError: there is no such interface.
    """
    module = INTERFACES[full_name].module
    __import__(module)  # importlib, whose function is nicer, costs more than a message class
    cls: type = getattr(sys.modules[module], full_name.rpartition("/")[2])
    return cls


def define(interface: Interface, namespace: dict[str, Any]) -> None:
    """Define the classes of `interface` in the dict of its module."""
    namespace.update(_SUPPORT)
    for structure in interface.structures():
        _define_message(interface, structure, namespace)
    if interface.kind == "srv":
        _define_service(interface, interface.name, namespace)
    elif interface.kind == "action":
        _define_action(interface, namespace)


def _define_message(interface: Interface, structure: Structure, namespace: dict[str, Any]) -> None:
    name = structure.name
    for field in structure.fields:
        if field.is_message and alias(field.base) not in namespace:
            short = field.base.rpartition("/")[2]
            beside = field.base.startswith(f"{interface.package}/{interface.kind}/")
            local = namespace.get(short) if beside else None
            namespace[alias(field.base)] = local or interface_class(field.base)
    attributes: dict[str, Any] = {"__doc__": f"Metaclass of message '{name}'."}
    for constant, literal in structure.constants:
        attributes[constant] = _fixed(f"lambda cls: {literal}", namespace)
    for field in structure.fields:
        if field.default is not None:
            attribute = f"{field.name.upper()}__DEFAULT"
            attributes[attribute] = _fixed(f"lambda cls: {default_source(field)}", namespace)
    _metaclass(interface, name, namespace, attributes)
    namespace[f"_slot_types_{name}"] = _SlotTypes(structure.fields)
    _execute(interface, class_source(structure), namespace)
    STRUCTURES[namespace[name]] = structure
    CLASSES[structure.full_name] = namespace[name]


def _fixed(source: str, namespace: dict[str, Any]) -> property:
    return property(eval(source, namespace))  # noqa: S307 - a literal of our own data file


def _metaclass(
    interface: Interface, name: str, namespace: dict[str, Any], attributes: dict[str, Any]
) -> None:
    attributes |= {"__module__": interface.module, "_TYPE_SUPPORT": None}
    namespace[f"Metaclass_{name}"] = type(f"Metaclass_{name}", (InterfaceType,), attributes)


def _define_service(interface: Interface, name: str, namespace: dict[str, Any]) -> None:
    _metaclass(interface, name, namespace, {"__doc__": f"Metaclass of service '{name}'."})
    source = f"""class {name}(metaclass=Metaclass_{name}):
    Request = {name}_Request
    Response = {name}_Response
    def __init__(self):
        raise NotImplementedError('Service classes can not be instantiated')
"""
    _execute(interface, source, namespace)


def _define_action(interface: Interface, namespace: dict[str, Any]) -> None:
    name = interface.name
    _define_service(interface, f"{name}_SendGoal", namespace)
    _define_service(interface, f"{name}_GetResult", namespace)
    namespace["_CancelGoal"] = interface_class("action_msgs/srv/CancelGoal")
    namespace["_GoalStatusArray"] = interface_class("action_msgs/msg/GoalStatusArray")
    _metaclass(interface, name, namespace, {"__doc__": f"Metaclass of action '{name}'."})
    source = f"""class {name}(metaclass=Metaclass_{name}):
    Goal = {name}_Goal
    Result = {name}_Result
    Feedback = {name}_Feedback
    class Impl:
        SendGoalService = {name}_SendGoal
        GetResultService = {name}_GetResult
        FeedbackMessage = {name}_FeedbackMessage
        CancelGoalService = _CancelGoal
        GoalStatusMessage = _GoalStatusArray
    def __init__(self):
        raise NotImplementedError('Action classes can not be instantiated')
"""
    _execute(interface, source, namespace)


def _execute(interface: Interface, source: str, namespace: dict[str, Any]) -> None:
    file_name = SITE_PACKAGES + interface.module.replace(".", "/") + ".py"
    exec(compile(source, file_name, "exec"), namespace)  # noqa: S102 - source of our own making


class _SlotTypes:
    """Stands in a class for its `SLOT_TYPES` until somebody asks for them."""

    def __init__(self, fields: list[Field]) -> None:
        self._fields = fields

    def __set_name__(self, owner: type, name: str) -> None:
        self._owner = owner

    def __get__(self, instance: object, owner: type) -> tuple[object, ...]:
        types = tuple(_slot_type(field) for field in self._fields)
        self._owner.SLOT_TYPES = types  # type: ignore[attr-defined]
        return types


def _slot_type(field: Field) -> object:
    from rosidl_parser import definition

    value_type: definition.AbstractNestableType
    if field.is_message:
        *namespaces, name = field.base.split("/")
        value_type = definition.NamespacedType(namespaces, name)
    elif field.base == "string":
        value_type = definition.BoundedString(field.bound) if field.bound else definition.UnboundedString()
    elif field.base == "wstring":
        value_type = definition.BoundedWString(field.bound) if field.bound else definition.UnboundedWString()
    else:
        value_type = definition.BasicType(field.base)
    if field.size is not None:
        return definition.Array(value_type, field.size)
    if field.maximum is not None:
        return definition.BoundedSequence(value_type, field.maximum)
    return definition.UnboundedSequence(value_type) if field.is_sequence else value_type


def _message_repr(self: Any) -> str:
    *packages, _ = type(self).__module__.split(".")  # none, for a class that a script has derived
    fields = []
    for name in type(self).get_fields_and_field_types():
        value = getattr(self, name)
        text = repr(value)
        if isinstance(value, array):
            text = text[len("array('X', ") : -1] if value else "[]"
        fields.append(f"{name}={text}")
    return f"{'.'.join((*packages, type(self).__name__))}({', '.join(fields)})"


@classmethod  # type: ignore[misc]
def _get_fields_and_field_types(cls: Any) -> dict[str, str]:
    return dict(cls._fields_and_field_types)


def _check_arguments(message: Any, arguments: dict[str, Any]) -> None:
    unknown = sorted(name for name in arguments if f"_{name}" not in message.__slots__)
    assert not unknown, f"Invalid arguments passed to constructor: {', '.join(unknown)}"


def _is_list(value: object) -> bool:
    if type(value) in (list, tuple):
        return True
    from collections import UserString
    from collections.abc import Sequence, Set

    return isinstance(value, (Sequence, Set)) and not isinstance(value, (str, UserString))


def _is_text(value: object) -> bool:
    if isinstance(value, str):
        return True
    from collections import UserString

    return isinstance(value, UserString)


def _is_ndarray(value: object) -> bool:
    numpy = sys.modules.get("numpy")
    return numpy is not None and isinstance(value, numpy.ndarray)


def _to_numpy(value: Any, dtype: str) -> Any:
    import numpy

    return numpy.array(value, dtype=dtype)


def _pack(value: Any, code: str, size: int) -> bytes | None:
    """Return the bytes of a plain list of numbers, None for what only numpy can tell."""
    if type(value) not in (list, tuple) or len(value) != size:
        return None
    try:
        return array(code, value).tobytes()
    except (TypeError, OverflowError):
        return None


NUMBERS_PER_STEP = 512
"""Of a list that becomes an array; as many take 10 us."""


def _converted(value: list[Any], code: str) -> Any:
    """Return the array of a list whose numbers are all right, otherwise the list: the setter's checks say why.

    They look at each number in Python, which for the bytes of one small picture takes 40 ms. What is done here
    takes 10 ms for a large one, so it counts as steps.
    """
    kernel.steps += len(value) // NUMBERS_PER_STEP
    if code in "fd":
        if list(map(type, value)).count(float) != len(value):
            return value
    elif not _is_whole(value):
        return value
    if code == "f" and value:
        total = sum(value)
        if total != total or min(value) < -FLOAT_BOUND or max(value) > FLOAT_BOUND:  # noqa: PLR0124 - NaN
            return value
    try:
        # an array takes numbers one by one, and bytes at once
        return array(code, bytearray(value) if code == "B" else pack(f"{len(value)}{code}", *value))
    except (OverflowError, ValueError, StructError):
        return value


def _is_whole(value: list[Any]) -> bool:
    """Whether a list has whole numbers alone: the sum of any others is of their kind, or cannot be had."""
    try:
        return type(sum(value)) is int
    except TypeError:
        return False


def _array_getter(slot: str, code: str, dtype: str) -> Any:
    """Return the getter of a fixed-size array of numbers, which makes it numpy's at the first look."""

    def get(self: Any) -> Any:
        value = getattr(self, slot)
        if isinstance(value, bytes):
            value = _to_numpy(array(code, value), dtype)
            setattr(self, slot, value)
        return value

    return get


_SUPPORT = {
    "_property": property,
    "_getter": attrgetter,
    "_array_getter": _array_getter,
    "_array": array,
    "_isinf": isinf,
    "_is_list": _is_list,
    "_is_text": _is_text,
    "_is_ndarray": _is_ndarray,
    "_to_numpy": _to_numpy,
    "_pack": _pack,
    "_converted": _converted,
    "_check_arguments": _check_arguments,
    "_message_repr": _message_repr,
    "_get_fields_and_field_types": _get_fields_and_field_types,
}
"""What the generated source refers to."""
