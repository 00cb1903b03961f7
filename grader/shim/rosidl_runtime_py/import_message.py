"""The class of an interface from the description of its name."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def import_message_from_namespaced_type(message_type: Any) -> Any:
    """Return the class that a `NamespacedType` names.

    Raises:
        ModuleNotFoundError, AttributeError: no such package, no such interface.
    """
    module = import_module(".".join(message_type.namespaces))
    if message_type.name.endswith("_FeedbackMessage"):
        action, name = message_type.name.rsplit("_", 1)
        return getattr(getattr(module, action).Impl, name)
    return getattr(module, message_type.name)
