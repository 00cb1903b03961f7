"""Interface classes from their names."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def get_interface(identifier: str) -> Any:
    """Return the class of e.g. ``std_msgs/msg/String`` or ``turtlesim/srv/Spawn``.

    Raises:
        ValueError: not the form of an interface's name.
        ModuleNotFoundError, AttributeError: no such package, no such interface.
    """
    parts = identifier.split("/")
    if len(parts) < 2 or not all(parts):
        raise ValueError(f"Expected the full name of an interface, got '{identifier}'")
    return getattr(import_module(".".join(parts[:-1])), parts[-1])


def get_message(identifier: str) -> Any:
    """Return the message class of e.g. ``std_msgs/msg/String``.

    Raises:
        ValueError: not a message.
    """
    return _checked(get_interface(identifier), identifier, "a message", ("_fields_and_field_types",))


def get_service(identifier: str) -> Any:
    """Return the service class of e.g. ``turtlesim/srv/Spawn``.

    Raises:
        ValueError: not a service.
    """
    return _checked(get_interface(identifier), identifier, "a service", ("Request", "Response"))


def get_action(identifier: str) -> Any:
    """Return the action class of e.g. ``turtlesim/action/RotateAbsolute``.

    Raises:
        ValueError: not an action.
    """
    return _checked(get_interface(identifier), identifier, "an action", ("Goal", "Result", "Feedback"))


def _checked(interface: Any, identifier: str, kind: str, attributes: tuple[str, ...]) -> Any:
    if not all(hasattr(interface, attribute) for attribute in attributes):
        raise ValueError(f"Expected the full name of {kind}, got '{identifier}'")
    return interface
