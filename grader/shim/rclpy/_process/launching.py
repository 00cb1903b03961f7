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
    own = _own(_started())
    if not own:
        sys.exit(1)
    if len(own) > 1:
        from rclpy._process.side_by_side import run

        link.note(_SEVERAL_NOTE, ", ".join(f"{each.package}/{each.executable}" for each in own)[:1000])
        run(own, guard)
        return
    node = own[0]
    if node.delay_s > 0.0:
        import time

        time.sleep(node.delay_s)  # virtual
    workspace.choose(node.package, node.executable)
    sys.argv = [executable_path(node.package, node.executable), *node.arguments]
    workspace.call()


def _started() -> list[tuple[Any, str, Any]]:
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
    _answer(context)
    return context.started


def _answer(context: Any) -> None:
    """Do what is to come when something starts, or when a command has ended."""
    from launch.event_handlers import OnProcessExit, OnProcessStart

    done = 0
    while done < len(context.handlers):
        handler, scope = context.handlers[done]
        done += 1
        context.restore(scope)
        for action, kind, what in list(context.started):
            if handler.target_action is not action:
                continue
            if isinstance(handler, OnProcessExit) and kind == "node":
                what.untold.append("OnProcessExit")
            elif isinstance(handler, (OnProcessExit, OnProcessStart)):
                actions = handler.actions
                context.visit(actions(None, context) if callable(actions) else actions)


def _own(started: list[tuple[Any, str, Any]]) -> list[Any]:
    """Return the nodes of the workspace; if there is none, say so.

    Raises:
        SubstitutionFailure: a package has no such executable: launch then starts nothing more at home.
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
    if not own:
        sys.stderr.write("the launch file starts no node of your own package\n")
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
