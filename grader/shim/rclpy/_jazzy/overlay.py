"""Applying a module of Jazzy's differences to one of Humble: classes change in place, all else is replaced."""

from __future__ import annotations

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType
    from typing import Any, TypeVar

    ClassT = TypeVar("ClassT", bound=type)

_OF_THE_CLASS_ITSELF = frozenset(
    (
        *("__annotations__", "__dict__", "__doc__", "__firstlineno__", "__module__", "__qualname__"),
        *("__slots__", "__static_attributes__", "__weakref__"),
    )
)


def extends(changed: type) -> Callable[[ClassT], ClassT]:
    """Give a class of Humble the attributes of the decorated one, which has its name and derives from it.

    Whoever holds the class, or an object of it, has the new attributes. `super()` is of no use there: what is
    to be called of the old attributes is kept before.
    """

    def decorate(cls: ClassT) -> ClassT:
        for name, value in vars(cls).items():
            if name not in _OF_THE_CLASS_ITSELF:
                setattr(changed, name, value)
        return changed  # type: ignore[return-value]

    return decorate


def replace(module: ModuleType, **new: Any) -> None:
    """Replace values of a module, also where other modules of rclpy have imported them."""
    old = {name: module.__dict__.get(name) for name in new}
    vars(module).update(new)
    for other in [vars(sys.modules[name]) for name in sys.modules if name.startswith("rclpy")]:
        for name, value in new.items():
            if old[name] is not None and other.get(name) is old[name]:
                other[name] = value
