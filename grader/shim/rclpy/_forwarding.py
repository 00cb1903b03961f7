"""Names that a module of upstream passes on because it imports them.

Editors complete ``from rclpy.node import Timer``, and that works on Humble; here such a name is looked up when
a script asks for it.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any


def forwarding(module: str, names: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the `__getattr__` of `module`; `names` are separated by spaces, by the module they come from."""

    def find(name: str) -> Any:
        for home, passed_on in names.items():
            if name in passed_on.split():
                from importlib import import_module

                return getattr(import_module(home), name)
        raise AttributeError(f"module {module!r} has no attribute {name!r}")

    return find
