"""Launch files. Those in XML and YAML are not read here."""

from __future__ import annotations

from types import ModuleType

from rclpy._process import loops
from rclpy._process.packages import workspace

from launch._evaluation import LaunchContext, LaunchDescription, perform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class InvalidPythonLaunchFileError(Exception):
    """A launch file has no ``generate_launch_description``."""


class LaunchDescriptionSource:
    """A launch file."""

    def __init__(self, location: Any) -> None:
        self.location = location

    def path(self, context: LaunchContext) -> str:
        """Return where it is."""
        return perform(context, self.location)

    def read(self, context: LaunchContext) -> LaunchDescription:
        """Return what it describes.

        Raises:
            InvalidPythonLaunchFileError: it does not say so, or is not Python.
            OSError: there is no such file.
        """
        path = self.path(context)
        with open(path, "rb") as file:
            source = file.read()
        if not path.endswith(".py"):
            raise InvalidPythonLaunchFileError(
                f"launch file '{path}': only launch files in Python are run here"
            )
        module = ModuleType("launch_file")
        module.__file__ = path
        exec(loops.compile_script(source, workspace.shown(path)), module.__dict__)  # noqa: S102
        generate = module.__dict__.get("generate_launch_description")
        if generate is None:
            raise InvalidPythonLaunchFileError(
                f"launch file at '{path}' does not contain the required function 'generate_launch_description()'"
            )
        found = generate()
        if not isinstance(found, LaunchDescription):
            raise InvalidPythonLaunchFileError(
                f"generate_launch_description() of '{path}' returns {found!r}, no LaunchDescription"
            )
        return found


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python."""

    def __init__(self, launch_file_path: Any) -> None:
        super().__init__(launch_file_path)


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file of any kind."""

    def __init__(self, launch_file_path: Any) -> None:
        super().__init__(launch_file_path)
