"""Filling a message from plain data."""

from __future__ import annotations

from functools import partial
from typing import Any

from rosidl_parser.definition import AbstractNestedType, NamespacedType

from rosidl_runtime_py.utilities import get_interface

_ELEMENTS: dict[str, Any] = {"float": float, "double": float, "boolean": bool, "string": str, "octet": bytes}


def set_message_fields(
    msg: Any, values: dict[str, Any], expand_header_auto: bool = False, expand_time_now: bool = False
) -> list[Any]:
    """Set the fields of `msg` named in `values`; nested dicts fill nested messages.

    `expand_header_auto`: take ``auto`` for a Header with a time that is set later, `expand_time_now`: ``now`` for
    a Time.

    Returns:
        Functions that set these times when they are called with one.

    Raises:
        AttributeError: there is no such field.
        TypeError, ValueError: a value cannot become its field's type.
    """
    later = _Later(expand_header_auto, expand_time_now)
    later.set_fields(msg, values)
    return later.setters


class _Later:
    """Sets fields, and keeps those in mind that are set later."""

    def __init__(self, headers: bool, times: bool) -> None:
        self.setters: list[Any] = []
        self._headers = headers
        self._times = times

    def set_fields(self, msg: Any, values: Any) -> None:
        """Set the fields of a message."""
        try:
            items = values.items()
        except AttributeError:
            raise TypeError(
                f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}"
            ) from None
        types = dict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))
        for name, value in items:
            current = getattr(msg, name)
            if not self._is_later(msg, name, current, value):
                setattr(msg, name, self._converted(current, types[name], value))

    def _is_later(self, msg: Any, name: str, current: Any, value: Any) -> bool:
        kind = f"{type(current).__module__}.{type(current).__name__}"
        if self._headers and kind == "std_msgs.msg._header.Header" and value == "auto":
            self.setters.append(partial(setattr, current, "stamp"))
            return True
        if self._times and kind == "builtin_interfaces.msg._time.Time" and value == "now":
            self.setters.append(partial(setattr, msg, name))
            return True
        return False

    def _converted(self, current: Any, kind: Any, value: Any) -> Any:
        if isinstance(kind, NamespacedType):
            return self._message(type(current), value)
        if isinstance(kind, AbstractNestedType):
            if isinstance(kind.value_type, NamespacedType):
                element = get_interface("/".join(kind.value_type.namespaced_name()))
                return [self._message(element, item) for item in value]
            return value if type(value) is type(current) else _plain_list(kind, value)
        return value if type(value) is type(current) else type(current)(value)

    def _message(self, cls: Any, value: Any) -> Any:
        if isinstance(value, cls):
            return value
        message = cls()
        self.set_fields(message, value)
        return message


def _plain_list(kind: AbstractNestedType, value: Any) -> list[Any]:
    typename = getattr(kind.value_type, "typename", "string")
    element = _ELEMENTS.get(typename, int)
    return [item if isinstance(item, element) else element(item) for item in value]
