"""Interface classes from their names."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rosidl_parser.definition import NamespacedType

from rosidl_runtime_py.import_message import import_message_from_namespaced_type


def get_interface(identifier: str) -> Any:
    """Return the class of e.g. ``std_msgs/msg/String`` or ``turtlesim/srv/Spawn``.

    Raises:
        ValueError: not the form of an interface's name.
        ModuleNotFoundError, AttributeError: no such package, no such interface.
    """
    return import_message_from_namespaced_type(get_namespaced_type(identifier))


def get_message(identifier: str) -> Any:
    """Return the message class of e.g. ``std_msgs/msg/String``, or ``std_msgs/String``.

    Raises ValueError: not a message.
    """
    return _imported(identifier, get_message_namespaced_type, is_message, "a message")


def get_service(identifier: str) -> Any:
    """Return the service class of e.g. ``turtlesim/srv/Spawn``, or ``turtlesim/Spawn``.

    Raises ValueError: not a service.
    """
    return _imported(identifier, get_service_namespaced_type, is_service, "a service")


def get_action(identifier: str) -> Any:
    """Return the action class of e.g. ``turtlesim/action/RotateAbsolute``, or without ``action``.

    Raises ValueError: not an action.
    """
    return _imported(identifier, get_action_namespaced_type, is_action, "an action")


def get_namespaced_type(identifier: str) -> NamespacedType:
    """Return the description of an interface's full name.

    Raises ValueError: not the form of an interface's name.
    """
    return _namespaced(identifier)


def get_message_namespaced_type(identifier: str) -> NamespacedType:
    """Return the description of a message's name; ``msg`` may be left out of it."""
    return _namespaced(identifier, "msg")


def get_service_namespaced_type(identifier: str) -> NamespacedType:
    """Return the description of a service's name; ``srv`` may be left out of it."""
    return _namespaced(identifier, "srv")


def get_action_namespaced_type(identifier: str) -> NamespacedType:
    """Return the description of an action's name; ``action`` may be left out of it."""
    return _namespaced(identifier, "action")


def is_message(interface: Any) -> bool:
    """Return whether a class is a message's."""
    return hasattr(interface, "SLOT_TYPES")


def is_service(interface: Any) -> bool:
    """Return whether a class is a service's."""
    return hasattr(interface, "Request") and hasattr(interface, "Response")


def is_action(interface: Any) -> bool:
    """Return whether a class is an action's."""
    return all(hasattr(interface, name) for name in ("Goal", "Result", "Feedback"))


def _namespaced(identifier: str, default: str = "") -> NamespacedType:
    *spaces, name = identifier.split("/")
    if not spaces or not all((*spaces, name)):
        raise ValueError(f"Expected the full name of an interface, got '{identifier}'")
    return NamespacedType([*spaces, default] if default and len(spaces) == 1 else spaces, name)


def _imported(
    identifier: str, type_of: Callable[[str], NamespacedType], is_kind: Callable[[Any], bool], kind: str
) -> Any:
    interface = import_message_from_namespaced_type(type_of(identifier))
    if not is_kind(interface):
        raise ValueError(f"Expected the full name of {kind}, got '{identifier}'")
    return interface
