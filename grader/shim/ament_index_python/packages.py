"""Prefixes and share folders of packages. A package is known when colcon would have built it, or ROS brings it."""

from __future__ import annotations

import os

from rclpy import _distro
from rclpy._interfaces.importer import PACKAGES
from rclpy._process.packages import workspace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from pathlib import Path

_OF_ROS = frozenset(
    {"rclpy", "turtlesim", "launch", "launch_ros", "ament_index_python", "tf2_ros", "demo_nodes_py"}
)


class PackageNotFoundError(KeyError):
    """No such package is installed."""


def get_package_prefix(package_name: str) -> str:
    """Return the prefix of a package.

    Raises:
        PackageNotFoundError: it is not installed.
        ValueError: that is no name of a package.
    """
    if not package_name or not package_name.replace("_", "").replace("-", "").isalnum():
        raise ValueError(f"'{package_name}' is not a valid package name")
    prefix = workspace.prefix_of(package_name)
    if prefix:
        return prefix
    if package_name in _OF_ROS or package_name in PACKAGES:
        return _ros()
    searched = [*workspace.prefixes(), _ros()]
    raise PackageNotFoundError(f"package '{package_name}' not found, searching: {searched}")


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """Return the share folder of a package. Raises as `get_package_prefix`."""
    return os.path.join(get_package_prefix(package_name), "share", package_name)


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """Return the share folder of a package as a path. Raises as `get_package_prefix`."""
    from pathlib import Path

    return Path(get_package_share_directory(package_name))


def get_packages_with_prefixes() -> dict[str, str]:
    """Return the prefixes of all packages by their names."""
    prefixes = {name: _ros() for name in sorted({*_OF_ROS, *PACKAGES})}
    return {**prefixes, **{name: workspace.prefix_of(name) for name in workspace.names}}


def _ros() -> str:
    return f"/opt/ros/{_distro.chosen}"
