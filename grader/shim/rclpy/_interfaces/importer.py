"""Makes every interface package importable: ``from geometry_msgs.msg import Twist``.

No such package exists on disk. A finder on `sys.meta_path` answers for ``geometry_msgs``,
``geometry_msgs.msg`` and ``geometry_msgs.msg._twist`` alike, as a ROS 2 Humble installation lays them out;
the classes of a module are built when it is imported, and ``geometry_msgs.msg`` imports a module when one of
its names is first asked for. Importing this module installs the finder.
"""

from __future__ import annotations

import sys
from _frozen_importlib import ModuleSpec  # importlib.machinery has it from here

from rclpy._interfaces.definitions import INTERFACES, SITE_PACKAGES, Interface, parsed
from rclpy._interfaces.messages import define, interface_class

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType
    from typing import Any

PACKAGES = {full_name.partition("/")[0] for full_name in INTERFACES}
"""Names of the interface packages."""

_NAMESPACES = {full_name.rpartition("/")[0].replace("/", ".") for full_name in INTERFACES}
_by_module: dict[str, dict[str, Interface]] = {}


def _interfaces_of(namespace: str) -> dict[str, Interface]:
    """Return the interfaces of e.g. ``geometry_msgs.msg`` by the names of their modules."""
    interfaces = _by_module.get(namespace)
    if interfaces is None:
        prefix = namespace.replace(".", "/") + "/"
        members = [interface for name, interface in INTERFACES.items() if name.startswith(prefix)]
        interfaces = _by_module[namespace] = {interface.module: interface for interface in members}
    return interfaces


def _interface(module: str) -> Interface | None:
    """Return the interface whose module has this name."""
    namespace = module.rpartition(".")[0]
    return _interfaces_of(namespace).get(module) if namespace in _NAMESPACES else None


def add(entries: list[str]) -> None:
    """Make the interfaces that an assignment brings along importable like ROS's own."""
    include(parsed(entries))


def include(found: dict[str, Interface]) -> None:
    """Make interfaces importable, instead of those of the same names."""
    INTERFACES.update(found)
    PACKAGES.update(name.partition("/")[0] for name in found)
    _NAMESPACES.update(name.rpartition("/")[0].replace("/", ".") for name in found)


class InterfaceFinder:
    """Finder and loader of the interface packages (one object, without state)."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of an interface package or of one of its modules, None for anything else."""
        if fullname in PACKAGES or fullname in _NAMESPACES:
            is_package = True
        elif _interface(fullname) is not None:
            is_package = False
        else:
            return None
        origin = SITE_PACKAGES + fullname.replace(".", "/") + ("/__init__.py" if is_package else ".py")
        # A loader by its methods: the base class in importlib.abc would cost more than all of this.
        loader: Any = InterfaceFinder
        spec = ModuleSpec(fullname, loader, origin=origin, is_package=is_package)
        spec.has_location = True
        return spec

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Ask for an ordinary module."""

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        """Fill a module: with its classes, or with the promise of them."""
        name = module.__name__
        if name in _NAMESPACES:
            _promise(module, {interface.name: interface for interface in _interfaces_of(name).values()})
        elif (interface := _interface(name)) is not None:
            define(interface, module.__dict__)


def _promise(module: ModuleType, interfaces: dict[str, Interface]) -> None:
    """Give ``geometry_msgs.msg`` its names without importing what they stand for."""

    def __getattr__(name: str) -> Any:  # noqa: N807 - the hook of PEP 562
        if name in interfaces:
            value = interface_class(interfaces[name].full_name)
            setattr(module, name, value)
            return value
        submodule = f"{module.__name__}.{name}"
        if _interface(submodule) is not None:
            __import__(submodule)
            return sys.modules[submodule]
        raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}", name=name, obj=module)

    def __dir__() -> list[str]:  # noqa: N807 - the hook of PEP 562
        return sorted({*module.__dict__, *interfaces} - {"__getattr__", "__dir__", "__all__"})

    module.__dict__.update(__getattr__=__getattr__, __dir__=__dir__, __all__=sorted(interfaces))


def install() -> None:
    """Put the finder first on `sys.meta_path`, once."""
    if InterfaceFinder not in sys.meta_path:
        sys.meta_path.insert(0, InterfaceFinder)


install()


class LogType:
    """Stands for rcl_interfaces/msg/Log where only its name is needed: every node has a log publisher."""

    __module__ = "rcl_interfaces.msg"
    __qualname__ = __name__ = "Log"
