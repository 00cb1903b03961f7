"""Where packages and their programs are, and parameters that were set before."""

from __future__ import annotations

import os

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch._evaluation import LaunchContext, Substitution, checked, perform
from launch._modules import offer
from launch.substitutions import SubstitutionFailure
from rclpy import _distro
from rclpy._process.packages import executable_path, workspace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["ExecutableInPackage", "FindPackage", "FindPackagePrefix", "FindPackageShare", "Parameter"]


class FindPackage(Substitution):
    """The place of a package, which classes made from it find."""

    def __init__(self, package: Any) -> None:
        checked(package)
        self.package = package

    def find(self, package_name: str) -> str:
        """Return the place of a package."""
        raise NotImplementedError

    def perform(self, context: LaunchContext) -> str:
        return self.find(perform(context, self.package))


class FindPackagePrefix(FindPackage):
    """The prefix of a package."""

    def find(self, package_name: str) -> str:
        return get_package_prefix(package_name)


class FindPackageShare(FindPackage):
    """The share folder of a package."""

    def find(self, package_name: str) -> str:
        return get_package_share_directory(package_name)


class ExecutableInPackage(FindPackagePrefix):
    """The path of a package's program. Of ROS's own packages any is taken to be there."""

    def __init__(self, executable: Any, package: Any) -> None:
        super().__init__(package)
        checked(executable)
        self.executable = executable

    def perform(self, context: LaunchContext) -> str:
        executable, package = perform(context, self.executable), perform(context, self.package)
        prefix = super().perform(context)
        if package not in workspace.names:
            return os.path.join(prefix, "lib", package, executable)
        path, known = executable_path(package, executable), workspace.executables_of(package)
        folder = os.path.dirname(path)
        if not known:
            found = f"package '{package}' found at '{prefix}'"
            raise SubstitutionFailure(f"{found}, but libexec directory '{folder}' does not exist")
        if executable not in known:
            raise SubstitutionFailure(
                f"executable '{executable}' not found on the libexec directory '{folder}' "
            )
        return path


class Parameter(Substitution):
    """A parameter that SetParameter has set before. Only on Jazzy it can have a default."""

    def __init__(self, name: Any, **default: Any) -> None:
        if default and (_distro.chosen == _distro.HUMBLE or set(default) != {"default"}):
            raise TypeError(
                f"Parameter.__init__() got an unexpected keyword argument '{next(iter(default))}'"
            )
        checked(name)
        self.name = name
        self._default = default.get("default")

    def perform(self, context: LaunchContext) -> str:
        name = perform(context, self.name)
        for entry in context.launch_configurations.get("global_params", ()):
            if isinstance(entry, tuple) and entry[0] == name:
                return str(entry[1])
        if self._default is None:
            raise SubstitutionFailure(f"parameter '{name}' not found")
        given = self._default
        parts = given if isinstance(given, (list, tuple)) else [given]
        return "".join(perform(context, x) if isinstance(x, (str, Substitution)) else str(x) for x in parts)


offer(__name__)
