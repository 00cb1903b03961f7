"""Filling a message from plain data."""

from __future__ import annotations

from typing import Any

from rosidl_parser.definition import AbstractNestedType, NamespacedType

from rosidl_runtime_py.utilities import get_interface

_ELEMENTS: dict[str, Any] = {"float": float, "double": float, "boolean": bool, "string": str, "octet": bytes}


def set_message_fields(msg: Any, values: dict[str, Any]) -> None:
    """Set the fields of `msg` named in `values`; nested dicts fill nested messages.

    Raises:
        AttributeError: there is no such field.
        TypeError, ValueError: a value cannot become its field's type.
    """
    try:
        items = values.items()
    except AttributeError:
        raise TypeError(
            f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}"
        ) from None
    types = dict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))
    for name, value in items:
        current = getattr(msg, name)
        setattr(msg, name, _converted(current, types[name], value))


def _converted(current: Any, kind: Any, value: Any) -> Any:
    if isinstance(kind, NamespacedType):
        return _message(type(current), value)
    if isinstance(kind, AbstractNestedType):
        if isinstance(kind.value_type, NamespacedType):
            element = get_interface("/".join(kind.value_type.namespaced_name()))
            return [_message(element, item) for item in value]
        return value if type(value) is type(current) else _plain_list(kind, value)
    return value if type(value) is type(current) else type(current)(value)


def _message(cls: Any, value: Any) -> Any:
    if isinstance(value, cls):
        return value
    message = cls()
    set_message_fields(message, value)
    return message


def _plain_list(kind: AbstractNestedType, value: Any) -> list[Any]:
    typename = getattr(kind.value_type, "typename", "string")
    element = _ELEMENTS.get(typename, int)
    return [item if isinstance(item, element) else element(item) for item in value]
