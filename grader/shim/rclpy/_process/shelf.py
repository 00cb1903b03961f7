"""Modules that are loaded ahead of a script without being there for it before it imports them.

``import rclpy`` alone does not make `rclpy.node` an attribute, at home and here; that must not depend on what
the process that scripts are forked from has imported already.
"""

from __future__ import annotations

import sys
from _frozen_importlib import ModuleSpec

from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from types import ModuleType
    from typing import Any


class Shelf:
    """Finder and loader that hands out, once each, the modules put on it."""

    def __init__(self) -> None:
        self._modules: dict[str, ModuleType] = {}
        self._specs: dict[str, Any] = {}

    def put(self, names: Iterable[str]) -> None:
        """Take modules out of `sys.modules` and out of their packages until they are imported."""
        for name in names:
            self._modules[name] = module = sys.modules.pop(name)
            self._specs[name] = module.__spec__
            parent, _, child = name.rpartition(".")
            package = sys.modules.get(parent) or self._modules.get(parent)
            if package is not None and package.__dict__.get(child) is module:
                delattr(package, child)

    def names(self) -> list[str]:
        """Return the names of the modules on the shelf."""
        return list(self._modules)

    def forget(self, names: Iterable[str]) -> None:
        """Remove modules from the shelf, so that another finder imports them anew."""
        for name in names:
            self._modules.pop(name, None)
            self._specs.pop(name, None)

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname not in self._modules:
            return None
        loader: Any = self
        return ModuleSpec(fullname, loader, is_package=hasattr(self._modules[fullname], "__path__"))

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._modules.pop(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Give the module its own spec and loader back; it was executed when it was loaded."""
        module.__spec__ = spec = self._specs.pop(module.__name__)
        module.__loader__ = spec.loader
        if module.__name__ == "threading":
            kernel.charge()  # executed now, it would ask a lock


shelf = Shelf()
sys.meta_path.insert(0, shelf)
