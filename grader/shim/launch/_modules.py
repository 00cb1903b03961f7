"""Modules that upstream has for each class, such as `launch.actions.execute_process`.

Here several classes share a module. One of upstream's that is asked for is made of the package that passes its
names on; what that package does not have, it has not either.
"""

from __future__ import annotations

import re
import sys
from _frozen_importlib import ModuleSpec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import ModuleType
    from typing import Any

_OTHERWISE = {
    "AllSubstitution": "boolean_substitution",
    "AndSubstitution": "boolean_substitution",
    "AnySubstitution": "boolean_substitution",
    "BaseEventHandler": "event_handler",
    "FindPackagePrefix": "find_package",
    "FindPackageShare": "find_package",
    "NotSubstitution": "boolean_substitution",
    "OrSubstitution": "boolean_substitution",
    "SomeActionsType_types_tuple": "some_actions_type",
    "SomeEntitiesType_types_tuple": "some_entities_type",
    "SomeSubstitutionsType_types_tuple": "some_substitutions_type",
    "evaluate_condition_expression": "evaluate_condition_expression_impl",
    "get_launch_description_from_any_launch_file": "any_launch_file_utilities",
    "get_launch_description_from_frontend_launch_file": "frontend_launch_file_utilities",
    "get_launch_description_from_python_launch_file": "python_launch_file_utilities",
    "load_python_launch_file_as_module": "python_launch_file_utilities",
    "matches_action": "matchers",
    "matches_executable": "process_matchers",
    "matches_name": "process_matchers",
    "matches_pid": "process_matchers",
}
"""Names that stand in a module called otherwise than they are."""


class _Modules:
    """Finder and loader of upstream's modules in some packages."""

    def __init__(self) -> None:
        self._packages: dict[str, tuple[str, ...]] = {}

    def offer(self, package: str, names: Iterable[str], otherwise: dict[str, str]) -> None:
        """Let the modules be found that upstream has for `names` in a package."""
        vars(sys.modules[package]).setdefault("__path__", [])
        for name in names:
            home = otherwise.get(name) or _OTHERWISE.get(name) or _snake(name)
            module = f"{package}.{home}"
            if home == name:
                continue  # imported, the module would take the name's place in the package
            self._packages[module] = (*self._packages.get(module, ()), name)

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Return the spec of one of these modules, None for anything else."""
        loader: Any = self
        return ModuleSpec(fullname, loader) if fullname in self._packages else None

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Ask for an ordinary module."""

    def exec_module(self, module: ModuleType) -> None:
        """Give a module its names."""
        package = vars(sys.modules[module.__name__.rpartition(".")[0]])
        for name in self._packages[module.__name__]:
            vars(module)[name] = package[name]


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


modules = _Modules()


def offer(package: str, *names: str, **otherwise: str) -> None:
    """Let the modules be found that upstream has for the names in a package; by default all of ``__all__``."""
    modules.offer(package, names or sys.modules[package].__all__, otherwise)


_finder: Any = modules
sys.meta_path.append(_finder)
