"""``ros2 launch PACKAGE FILE``: the description is evaluated, and its nodes of the workspace are called.

One is called as `ros2 run` would; several run side by side (`rclpy._process.side_by_side`).
"""

from __future__ import annotations

import sys

from rclpy._link import link
from rclpy._process.packages import executable_path, workspace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_TURTLESIM = ("turtlesim", "turtlesim_node")
_IGNORED_NOTE = "launch_ignored"
_SEVERAL_NOTE = "launch_several"
_MOST_NOTED = 5


def launch(guard: Any) -> None:
    """Evaluate the launch file and call its nodes.

    Args:
        guard: calls one of several nodes and takes what it raises for its end.

    Raises:
        SystemExit, and whatever the launch file or its one node raises.
    """
    launched = Launched(_described())
    own = launched.new_nodes()
    if not own:
        sys.stderr.write("the launch file starts no node of your own package\n")
        sys.exit(1)
    if len(own) > 1 or launched.goes_on:
        from rclpy._process.side_by_side import run

        if len(own) > 1:
            link.note(_SEVERAL_NOTE, ", ".join(f"{each.package}/{each.executable}" for each in own)[:1000])
        run(own, guard, launched.after)
        return
    node = own[0]
    if node.delay_s > 0.0:
        import time

        time.sleep(node.delay_s)  # virtual
    workspace.choose(node.package, node.executable)
    sys.argv = [executable_path(node.package, node.executable), *node.arguments]
    workspace.call()


def _described() -> Any:
    """Return the context in which the launch file was evaluated."""
    from launch._evaluation import LaunchContext
    from launch.launch_description_sources import PythonLaunchDescriptionSource

    path = workspace.launch_path()
    if not path:
        package = next(iter(workspace.names), "")
        share = f"{workspace.prefix_of(package)}/share/{package}"
        sys.stderr.write(
            f"file '{workspace.launch}' was not found in the share directory of package '{package}' "
            f"which is at '{share}'\n"
        )
        sys.exit(1)
    given = dict(each.split(":=", 1) for each in sys.argv[1:] if ":=" in each)
    context = LaunchContext(given)
    context.files.append(path)
    context.visit(PythonLaunchDescriptionSource(path).read(context).entities)
    return context


class Launched:
    """What a launch file has started, and what is to come when something starts or ends.

    A command, which is not run here, counts as ended at once.
    """

    def __init__(self, context: Any) -> None:
        self._context = context
        self._told = 0
        self._answered: set[tuple[int, int]] = set()

    @property
    def goes_on(self) -> bool:
        """Whether something is to come when a process ends."""
        from launch.event_handlers import OnProcessExit

        return any(isinstance(handler, OnProcessExit) for handler, _ in self._context.handlers)

    def new_nodes(self) -> list[Any]:
        """Do what is to come when something starts; return the nodes of the workspace that are new.

        Raises:
            SubstitutionFailure: a package has no such executable: launch then starts nothing more at home.
        """
        while self._answer():
            pass
        started = self._context.started[self._told :]
        self._told += len(started)
        return _own(started)

    def after(self, action: Any, code: int) -> list[Any]:
        """Do what is to come when the process of an action ends; return the nodes that start then.

        Raises:
            SubstitutionFailure: as `new_nodes`.
        """
        from launch.event_handlers import OnProcessExit

        for handler, scope in reversed(list(self._context.handlers)):  # launch asks the latest first
            if isinstance(handler, OnProcessExit) and handler.is_about(action):
                self._visit(handler, scope, action, code, 0.0)
        return self.new_nodes()

    def _answer(self) -> bool:
        """Answer what has started; return whether there was anything to answer."""
        from launch.event_handlers import OnProcessExit, OnProcessStart

        found = False
        for number, (handler, scope) in enumerate(list(self._context.handlers)):
            for place, (action, kind, what) in enumerate(list(self._context.started)):
                wanted = OnProcessStart if kind == "node" else (OnProcessExit, OnProcessStart)
                if (number, place) in self._answered or not isinstance(handler, wanted):
                    continue
                self._answered.add((number, place))
                if handler.is_about(action):
                    found = True
                    self._visit(handler, scope, action, 0, what.delay_s if kind == "node" else 0.0)
        return found

    def _visit(self, handler: Any, scope: Any, action: Any, code: int, delay_s: float) -> None:
        from launch.event_handlers import ProcessEvent

        self._context.restore(scope)
        self._context.delay_s = delay_s
        actions = handler.actions
        self._context.visit(
            actions(ProcessEvent(action, code), self._context) if callable(actions) else actions
        )


def _own(started: list[tuple[Any, str, Any]]) -> list[Any]:
    """Return the nodes of the workspace; note what else is not carried out.

    Raises:
        SubstitutionFailure: a package has no such executable.
    """
    own, ignored = [], []
    for _, kind, what in started:
        if kind == "node" and what.package in workspace.names:
            _check_executable(what.package, what.executable)
            own.append(what)
            ignored += [f"{each} of {what.package} {what.executable}" for each in what.untold]
        elif kind == "node" and (what.package, what.executable) == _TURTLESIM:
            if what.arguments != ["--ros-args"] and "-r" in what.arguments:
                ignored.append("turtlesim_node " + " ".join(what.arguments[1:]))
        else:
            ignored.append(what if kind == "command" else f"{what.package} {what.executable}")
    for text in ignored[:_MOST_NOTED]:
        link.note(_IGNORED_NOTE, text[:200])
    return own


def _check_executable(package: str, name: str) -> None:
    from launch.substitutions import SubstitutionFailure

    folder = executable_path(package, name).rpartition("/")[0]
    known = workspace.executables_of(package)
    if not known:
        found = f"package '{package}' found at '{workspace.prefix_of(package)}'"
        raise SubstitutionFailure(f"{found}, but libexec directory '{folder}' does not exist")
    if name not in known:
        raise SubstitutionFailure(f"executable '{name}' not found on the libexec directory '{folder}' ")
