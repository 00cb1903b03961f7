"""Launch files, in Python, XML and YAML."""

from __future__ import annotations

from types import ModuleType

from rclpy._process import loops
from rclpy._process.packages import workspace

from launch._evaluation import LaunchContext, LaunchDescription, checked, perform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any


__all__ = [
    "AnyLaunchDescriptionSource",
    "FrontendLaunchDescriptionSource",
    "InvalidFrontendLaunchFileError",
    "InvalidLaunchFileError",
    "InvalidPythonLaunchFileError",
    "PythonLaunchDescriptionSource",
    "get_launch_description_from_any_launch_file",
    "get_launch_description_from_frontend_launch_file",
    "get_launch_description_from_python_launch_file",
    "load_python_launch_file_as_module",
]


frontends: dict[str, Callable[[str], Callable[[], LaunchDescription]]] = {}
"""Readers of launch files in XML and YAML, which `launch.frontend.files` puts here: it needs the actions, and they
need sources. A reader returns what makes the description, once the text has been read."""


class InvalidLaunchFileError(Exception):
    """A file is no launch file."""


class InvalidPythonLaunchFileError(Exception):
    """A launch file has no ``generate_launch_description``."""


class InvalidFrontendLaunchFileError(InvalidLaunchFileError):
    """A launch file is neither XML nor YAML, or describes nothing."""


def load_python_launch_file_as_module(python_launch_file_path: str) -> ModuleType:
    """Return a launch file in Python as a module. Raises OSError: there is no such file."""
    with open(python_launch_file_path, "rb") as file:
        source = file.read()
    module = ModuleType("launch_file")
    module.__file__ = python_launch_file_path
    exec(loops.compile_script(source, workspace.shown(python_launch_file_path)), module.__dict__)  # noqa: S102
    return module


def get_launch_description_from_python_launch_file(python_launch_file_path: str) -> LaunchDescription:
    """Return what a launch file in Python describes.

    Raises:
        InvalidPythonLaunchFileError: it does not say so.
        OSError: there is no such file.
    """
    path = python_launch_file_path
    generate = load_python_launch_file_as_module(path).__dict__.get("generate_launch_description")
    if generate is None:
        raise InvalidPythonLaunchFileError(
            f"launch file at '{path}' does not contain the required function 'generate_launch_description()'"
        )
    description = generate()
    if not isinstance(description, LaunchDescription):
        raise InvalidPythonLaunchFileError(
            f"generate_launch_description() of '{path}' returns {description!r}, no LaunchDescription"
        )
    return description


def get_launch_description_from_frontend_launch_file(frontend_launch_file_path: str) -> LaunchDescription:
    """Return what a launch file in XML or YAML describes.

    Raises:
        InvalidFrontendLaunchFileError: it is neither.
        OSError: there is no such file.
        RuntimeError, AttributeError: an element is not known, or lacks an attribute.
    """
    with open(frontend_launch_file_path, "rb") as file:
        text = file.read().decode("utf-8")
    read = frontends["xml" if frontend_launch_file_path.endswith(".xml") else "yaml"]
    try:
        describe = read(text)
    except Exception as error:
        raise InvalidFrontendLaunchFileError(
            f"The launch file may have a syntax error, or its format is unknown: {error}"
        ) from None
    return describe()


def get_launch_description_from_any_launch_file(launch_file_path: str) -> LaunchDescription:
    """Return what a launch file describes.

    Raises:
        InvalidFrontendLaunchFileError: it is neither Python nor XML nor YAML.
        InvalidPythonLaunchFileError, OSError: as `get_launch_description_from_python_launch_file`.
    """
    if launch_file_path.endswith(".py"):
        return get_launch_description_from_python_launch_file(launch_file_path)
    return get_launch_description_from_frontend_launch_file(launch_file_path)


class LaunchDescriptionSource:
    """A description, or the file that it is read from when it is first asked for."""

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: Any = "<string>",
        method: str = "unspecified mechanism from a script",
    ) -> None:
        checked(location)
        self.method = method
        self._description = launch_description
        self._given = location
        self._expanded: str | None = None

    @property
    def location(self) -> str:
        """Where it is."""
        return str(self._given) if self._expanded is None else self._expanded

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the description.

        Raises:
            InvalidLaunchFileError, InvalidPythonLaunchFileError, OSError: the file says none.
        """
        self._expanded = perform(context, self._given)
        if self._description is None:
            self._description = self._get_launch_description(self._expanded)
        return self._description

    def _get_launch_description(self, location: str) -> LaunchDescription:
        raise RuntimeError(
            "LaunchDescriptionSource.get_launch_description(): called without launch description being set"
        )


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python."""

    def __init__(self, launch_file_path: Any) -> None:
        super().__init__(None, launch_file_path, "interpreted python launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_python_launch_file(location)


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in XML or YAML."""

    def __init__(self, launch_file_path: Any, *, parser: Any = None, method: str = "frontend") -> None:
        super().__init__(None, launch_file_path, method)

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_frontend_launch_file(location)


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file of any kind."""

    def __init__(self, launch_file_path: Any) -> None:
        super().__init__(None, launch_file_path, "any launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_any_launch_file(location)
