"""What would start a process: it is noted, and what launch files may ask about it is known."""

from __future__ import annotations

import os

from rclpy import _distro

from launch._evaluation import Action, Event, LaunchContext, checked, perform_bool
from launch._handlers import OnActionEventBase
from launch.descriptions import Executable
from launch.events.process import ProcessExited, ProcessStarted

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Any

_NO_DIFFERENCE = (
    "sigterm_timeout", "sigkill_timeout", "emulate_tty", "output_format", "cached_output", "log_cmd",
    "respawn_delay",
)  # fmt: skip
"""What can be said of a process that makes no difference here."""


class ExecuteLocal(Action):
    """A process, which is not started here; the launch file's author is told so.

    Attributes:
        process_details: name, command, folder, environment and number of the process; None: not started.
        return_code: how it ended; None: it has not.
    """

    def __init__(
        self,
        *,
        process_description: Executable,
        shell: bool = False,
        output: Any = "log",
        on_exit: Any = None,
        respawn: Any = False,
        **options: Any,
    ) -> None:
        known = (*_NO_DIFFERENCE, *(("respawn_max_retries",) if _distro.chosen == _distro.JAZZY else ()))
        super().__init__(**{name: value for name, value in options.items() if name not in known})
        if not isinstance(output, dict):
            checked(output)
        self.process_description = process_description
        self.shell = shell
        self.output = output
        self.process_details: dict[str, Any] | None = None
        self.return_code: int | None = None
        self._on_exit = on_exit
        self._respawn = respawn
        self._completion: Event | None = None

    def begin(self, context: LaunchContext) -> None:
        """Evaluate it, let its start be an event, and remember what is to come when it ends.

        Raises RuntimeError: it was started before.
        """
        if self.process_details is not None:
            raise RuntimeError(f"{type(self).__name__} action executed more than once: write another one")
        described = self.process_description
        described.prepare(context, self)
        self._respawn = perform_bool(context, self._respawn)
        self.process_details = {
            "action": self,
            "name": described.final_name,
            "cmd": described.final_cmd,
            "cwd": described.final_cwd,
            "env": described.final_env,
            "pid": os.getpid() + Executable.count,
        }
        if self._on_exit is not None:
            context.register_event_handler(
                OnActionEventBase(
                    action_matcher=self,
                    on_event=self._on_exit,
                    target_event_cls=ProcessExited,
                    target_action_cls=ExecuteLocal,
                )
            )
        context.emit_event_sync(ProcessStarted(**self.process_details))

    def end(self, context: LaunchContext, code: int) -> None:
        """Let its end be an event."""
        assert self.process_details is not None
        self.return_code = code
        context.emit_event_sync(ProcessExited(returncode=code, **self.process_details))
        if self._completion is not None:
            context.emit_event_sync(self._completion)

    def end_in(self, context: LaunchContext, event: Event) -> None:
        if self.return_code is None:
            self._completion = event
        else:
            context.emit_event_sync(event)

    def untold(self) -> list[str]:
        """Return what is said of it that is not carried out."""
        return ["respawn"] if self._respawn is True else []

    def execute_in(self, context: LaunchContext) -> None:
        self.begin(context)
        context.started.append((self, "command", " ".join(self.process_description.final_cmd or ())))
        self.end(context, 0)


class ExecuteProcess(ExecuteLocal):
    """A command, which is not run here and counts as ended at once."""

    def __init__(
        self,
        *,
        cmd: Iterable[Any],
        prefix: Any = None,
        name: Any = None,
        cwd: Any = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        **options: Any,
    ) -> None:
        described = Executable(
            cmd=cmd, prefix=prefix, name=name, cwd=cwd, env=env, additional_env=additional_env
        )
        super().__init__(process_description=described, **options)

    @property
    def cmd(self) -> list[Any]:
        """The command line as it was given, or once it is started as it is."""
        return self.process_description.final_cmd or self.process_description.cmd

    @property
    def name(self) -> Any:
        """The process's name as it was given, or once it is started as it is."""
        return self.process_description.final_name or self.process_description.name

    @property
    def cwd(self) -> Any:
        """The folder it works in, as `name`."""
        return self.process_description.final_cwd or self.process_description.cwd

    @property
    def env(self) -> Any:
        """Its environment, as `name`."""
        return self.process_description.final_env or self.process_description.env

    @property
    def additional_env(self) -> Any:
        """What is added to its environment, as it was given."""
        return self.process_description.additional_env
