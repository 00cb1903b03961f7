"""Which interfaces packages have, as the index of installed packages says at home."""

from __future__ import annotations

from collections.abc import Iterable

from ament_index_python.packages import get_packages_with_prefixes
from rclpy._interfaces import definitions


def get_interface_packages() -> list[str]:
    """Return the names of packages with interfaces."""
    return list(get_interfaces())


def get_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return interfaces such as ``msg/String`` by their packages, of all packages where none is named.

    Raises LookupError: there is no such package.
    """
    return _of_kind("", package_names)


def get_message_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return messages by their packages, as `get_interfaces`."""
    return _of_kind("msg", package_names)


def get_service_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return services by their packages, as `get_interfaces`."""
    return _of_kind("srv", package_names)


def get_action_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return actions by their packages, as `get_interfaces`."""
    return _of_kind("action", package_names)


def _of_kind(kind: str, package_names: Iterable[str]) -> dict[str, list[str]]:
    packages = list(package_names)
    for name in set(packages) - get_packages_with_prefixes().keys():
        raise LookupError(f"Unknown package '{name}'")
    interfaces: dict[str, list[str]] = {}
    for full_name in definitions.INTERFACES:
        package, _, rest = full_name.partition("/")
        if (not packages or package in packages) and (not kind or rest.startswith(f"{kind}/")):
            interfaces.setdefault(package, []).append(rest)
    return interfaces
