"""What a description can say: what would start a process is noted, the rest is done."""

from __future__ import annotations

import sys

from launch._evaluation import Action, LaunchContext, Substitution, checked, perform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class DeclareLaunchArgument(Action):
    """An argument of the launch file."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Any = None,
        description: Any = None,
        choices: Any = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        checked(default_value)
        self.name = name
        self.default_value = default_value
        self.choices = choices

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        if self.name not in context.launch_configurations:
            if self.default_value is None:
                raise RuntimeError(
                    f"Required launch argument '{self.name}' was not provided: give it a default_value"
                )
            context.launch_configurations[self.name] = perform(context, self.default_value)
        value = context.launch_configurations[self.name]
        if self.choices is not None and value not in self.choices:
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{value}" is not valid. '
                f"Valid options are: {list(self.choices)}"
            )


class SetLaunchConfiguration(Action):
    """Sets an argument."""

    def __init__(self, name: Any, value: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(name, value)
        self.name = name
        self.value = value

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        context.launch_configurations[perform(context, self.name)] = perform(context, self.value)


class SetEnvironmentVariable(Action):
    """Sets an environment variable."""

    def __init__(self, name: Any, value: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(name, value)
        self.name = name
        self.value = value

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        context.environment[perform(context, self.name)] = perform(context, self.value)


class LogInfo(Action):
    """Prints a line, as launch does."""

    def __init__(self, *, msg: Any, **options: Any) -> None:
        super().__init__(**options)
        checked(msg)
        self.msg = msg

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        sys.stdout.write(f"[INFO] [launch.user]: {perform(context, self.msg)}\n")


class GroupAction(Action):
    """Several actions; what they change of namespaces and arguments ends with them."""

    def __init__(self, actions: Any, *, scoped: bool = True, forwarding: bool = True, **options: Any) -> None:
        super().__init__(**options)
        self.actions = actions
        self.scoped = scoped

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        kept = context.scope()
        context.visit(self.actions, depth)
        if self.scoped:
            context.restore(kept)


class OpaqueFunction(Action):
    """A function that returns actions."""

    def __init__(self, *, function: Any, args: Any = (), kwargs: Any = None, **options: Any) -> None:
        super().__init__(**options)
        self.function = function
        self.args = args
        self.kwargs = kwargs or {}

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        context.visit(self.function(context, *self.args, **self.kwargs), depth)


class TimerAction(Action):
    """Actions that come later."""

    def __init__(self, *, period: Any, actions: Any, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(period, (float, str, Substitution, list, tuple)):
            kinds = "<class 'str'>, <class 'launch.substitution.Substitution'>, <class 'float'>"
            expected = f"'TimerAction' expected 'period' to be one of [{kinds}]"
            raise TypeError(f"{expected}, but got '{period}' of type '{type(period)}'")
        self.period = period
        self.actions = actions

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        before_s = context.delay_s
        period = self.period
        context.delay_s += period if isinstance(period, float) else float(perform(context, period))
        context.visit(self.actions, depth)
        context.delay_s = before_s


class IncludeLaunchDescription(Action):
    """The actions of another launch file."""

    def __init__(
        self, launch_description_source: Any, *, launch_arguments: Any = None, **options: Any
    ) -> None:
        super().__init__(**options)
        self.source = launch_description_source
        self.launch_arguments = [(name, value) for name, value in launch_arguments or ()]
        for each in self.launch_arguments:
            checked(*each)

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        from launch.launch_description_sources import PythonLaunchDescriptionSource

        source = self.source
        if isinstance(source, (str, tuple, list)):
            source = PythonLaunchDescriptionSource(source)
        for name, value in self.launch_arguments:
            context.launch_configurations[perform(context, name)] = perform(context, value)
        context.files.append(source.path(context))
        context.visit(source.read(context).entities, depth)
        context.files.pop()


_OF_PROCESSES = (
    "prefix", "name", "cwd", "env", "additional_env", "shell", "sigterm_timeout", "sigkill_timeout", "emulate_tty",
    "output", "output_format", "cached_output", "log_cmd", "respawn_delay", "respawn_max_retries",
)  # fmt: skip
"""What can be said of a process that makes no difference here."""


class ExecuteProcess(Action):
    """A command, which is not run here; the launch file's author is told so."""

    def __init__(self, *, cmd: Any, on_exit: Any = None, respawn: Any = False, **options: Any) -> None:
        super().__init__(**{name: value for name, value in options.items() if name not in _OF_PROCESSES})
        checked(*cmd)
        self.cmd = cmd
        self.on_exit = on_exit
        self.untold = ["respawn"] if respawn else []
        self.executed = False

    def begin(self, context: LaunchContext) -> None:
        """Note that it is started, and what is to come when it ends.

        Raises:
            RuntimeError: it was started before.
        """
        if self.executed:
            raise RuntimeError(f"{type(self).__name__} action executed more than once: write another one")
        self.executed = True
        if self.on_exit is not None:
            from launch.event_handlers import OnProcessExit

            handler = OnProcessExit(target_action=self, on_exit=self.on_exit)
            context.handlers.append((handler, context.scope()))

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        self.begin(context)
        words = [perform(context, each) for each in self.cmd]
        context.started.append((self, "command", " ".join(words)))


class RegisterEventHandler(Action):
    """Actions that come when something happens to a process."""

    def __init__(self, event_handler: Any, **options: Any) -> None:
        super().__init__(**options)
        self.event_handler = event_handler

    def execute_in(self, context: LaunchContext, depth: int) -> None:
        context.handlers.append((self.event_handler, context.scope()))


class EmitEvent(Action):
    """An event, such as the end of everything, which is not imitated."""

    def __init__(self, *, event: Any = None, **options: Any) -> None:
        super().__init__(**options)


class Shutdown(Action):
    """The end of everything, which is not imitated: a node that ends, ends the run."""

    def __init__(self, *, reason: Any = "", **options: Any) -> None:
        super().__init__(**options)
