"""Where packages are."""

from __future__ import annotations

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch._evaluation import LaunchContext, Substitution, perform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class FindPackagePrefix(Substitution):
    """The prefix of a package."""

    def __init__(self, package: Any) -> None:
        self.package = package

    def perform(self, context: LaunchContext) -> str:
        return get_package_prefix(perform(context, self.package))


FindPackage = FindPackagePrefix


class FindPackageShare(FindPackagePrefix):
    """The share folder of a package."""

    def perform(self, context: LaunchContext) -> str:
        return get_package_share_directory(perform(context, self.package))
