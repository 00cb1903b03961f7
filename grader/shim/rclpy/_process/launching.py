"""``ros2 launch PACKAGE FILE``: the description is evaluated, and its nodes of the workspace are called.

One is called as `ros2 run` would; several run side by side (`rclpy._process.side_by_side`).
"""

from __future__ import annotations

import difflib
import os
import sys

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._process.packages import executable_path, workspace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_TURTLESIM = ("turtlesim", "turtlesim_node")
_IGNORED_NOTE = "launch_ignored"
_SEVERAL_NOTE = "launch_several"
_MOST_NOTED = 5
_MISSPELT = 0.8  # as like a package of the workspace as that, a name is a mistyped one


def launch(guard: Any) -> None:
    """Evaluate the launch file and call its nodes.

    `guard` calls one of several nodes and takes what it raises for its end.

    Raises:
        SystemExit, and whatever the launch file or its one node raises.
    """
    from launch._evaluation import set_environment

    launched = Launched(*_described())
    own = launched.new_nodes()
    if not own:
        sys.stderr.write("the launch file starts no node of your own package\n")
        sys.exit(1)
    if len(own) > 1 or launched.goes_on:
        from rclpy._process.side_by_side import run

        if len(own) > 1:
            link.note(
                _SEVERAL_NOTE,
                ", ".join(f"{executable.package}/{executable.executable}" for executable in own)[:1000],
            )
        run(own, guard, launched)
        return
    node = own[0]
    if node.delay_s > 0.0:
        import time

        time.sleep(node.delay_s)  # virtual
    set_environment(node.environment)
    if node.cwd is not None:
        os.chdir(node.cwd)
    workspace.choose(node.package, node.executable)
    sys.argv = [executable_path(node.package, node.executable), *node.arguments]
    workspace.call()


def _described() -> tuple[Any, Any, str]:
    """Return a context, what the launch file describes, and where that is."""
    from launch._evaluation import LaunchContext
    from launch.frontend import files  # noqa: F401 - it reads launch files in XML and YAML, also included ones
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    path = workspace.launch_path()
    if not path:
        package = next(iter(workspace.names), "")
        share = f"{workspace.prefix_of(package)}/share/{package}"
        sys.stderr.write(
            f"file '{workspace.launch}' was not found in the share directory of package '{package}' "
            f"which is at '{share}'\n"
        )
        sys.exit(1)
    context = LaunchContext(argv=sys.argv[1:])
    context.launch_configurations |= dict(
        argument.split(":=", 1) for argument in sys.argv[1:] if ":=" in argument
    )
    return context, AnyLaunchDescriptionSource(path).get_launch_description(context), path


class Launched:
    """What a launch file has started, and what is to come when something starts or ends.

    A command, which is not run here, counts as ended at once.

    Attributes:
        shutdown_ns: when everything is to end because the launch file says so; None: it does not.
    """

    def __init__(self, context: Any, description: Any, path: str) -> None:
        from launch._handlers import EventHandler
        from launch.event_handlers import OnIncludeLaunchDescription, OnShutdown

        self.shutdown_ns: int | None = None
        self._context = context
        self._told = 0
        self._has_shut_down = False
        self._own_handlers: list[EventHandler | OnShutdown] = [
            OnIncludeLaunchDescription(),
            OnShutdown(on_shutdown=self._note_shutdown),
        ]
        for handler in self._own_handlers:
            context.register_event_handler(handler)
        context.files.append(path)
        context.visit([description])

    def _note_shutdown(self, event: Any, context: Any) -> None:
        self._has_shut_down = True
        now_ns = kernel.now_ns + round(context.delay_s * 1e9)
        self.shutdown_ns = now_ns if self.shutdown_ns is None else min(now_ns, self.shutdown_ns)

    @property
    def goes_on(self) -> bool:
        """Whether something is to come when a process ends, or everything does."""
        from launch.event_handlers import OnProcessStart

        later = [handler for handler in self._context.handlers if handler not in self._own_handlers]
        return self._has_shut_down or any(
            not handler.never and not isinstance(handler, OnProcessStart) for handler in later
        )

    def new_nodes(self) -> list[Any]:
        """Do what is to come when something happens; return the nodes of the workspace that are new.

        Raises:
            SubstitutionFailure: a package has no such executable: launch then starts nothing more at home.
            PackageNotFoundError: there is no such package, but one that is nearly called so.
        """
        context = self._context
        context.answer_events()
        started = context.started[self._told :]
        self._told += len(started)
        ignored, context.untold = context.untold, []
        return _own(context, started, ignored)

    def after(self, action: Any, code: int) -> list[Any]:
        """Do what is to come when the process of an action ends; return the nodes that start then.

        Raises as `new_nodes`.
        """
        self._context.delay_s = 0.0
        action.end(self._context, code)
        return self.new_nodes()

    def shut_down(self, reason: str, *, due_to_sigint: bool = False) -> None:
        """Do what is to come when everything ends, unless it has come already."""
        from launch.events import Shutdown

        if self._has_shut_down:
            return
        self._context.delay_s = 0.0
        self._context.emit_event_sync(Shutdown(reason=reason, due_to_sigint=due_to_sigint))
        self._context.answer_events()


def _own(context: Any, started: list[tuple[Any, str, Any]], ignored: list[str]) -> list[Any]:
    """Return the nodes of the workspace; note what else is not carried out. Raises as `Launched.new_nodes`."""
    from launch_ros.substitutions import ExecutableInPackage

    own = []
    for _, kind, what in started:
        if kind == "node" and what.package in workspace.names:
            ExecutableInPackage(what.executable, what.package).perform(context)
            own.append(what)
            ignored += [f"{name} of {what.package} {what.executable}" for name in what.untold]
        elif kind == "node" and (what.package, what.executable) == _TURTLESIM:
            if what.arguments != ["--ros-args"] and "-r" in what.arguments:
                ignored.append("turtlesim_node " + " ".join(what.arguments[1:]))
        elif kind == "node":
            _check_package(what.package)
            ignored.append(f"{what.package} {what.executable}".strip())
        else:
            ignored.append(what)
    for text in ignored[:_MOST_NOTED]:
        link.note(_IGNORED_NOTE, text[:200])
    return own


def _check_package(name: str) -> None:
    """Refuse what is most likely one's own package, misspelt; any other may be installed at home.

    Raises PackageNotFoundError: there is no such package, but one that is nearly called so.
    """
    from ament_index_python.packages import PackageNotFoundError, get_package_prefix

    plain = {known.lower().replace("-", "_") for known in workspace.names}
    if difflib.get_close_matches(name.lower().replace("-", "_"), plain, 1, _MISSPELT):
        try:
            get_package_prefix(name)
        except ValueError as error:
            raise PackageNotFoundError(str(error)) from None
