"""Events of processes. There is one process only here; each program of a launch has its own number as `pid`."""

from __future__ import annotations

import signal

from launch._evaluation import Event

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

__all__ = [
    "ProcessExited",
    "ProcessIO",
    "ProcessStarted",
    "ProcessStderr",
    "ProcessStdin",
    "ProcessStdout",
    "ProcessTargetedEvent",
    "RunningProcessEvent",
    "ShutdownProcess",
    "SignalProcess",
    "matches_executable",
    "matches_name",
    "matches_pid",
]


def _matches(holds: Callable[[dict[str, Any]], bool]) -> Callable[[Any], bool]:
    return lambda action: action.process_details is not None and holds(action.process_details)


def matches_pid(pid: int) -> Callable[[Any], bool]:
    """Return what recognises the action of a process by its number."""
    return _matches(lambda details: bool(details["pid"] == pid))


def matches_name(name: str) -> Callable[[Any], bool]:
    """Return what recognises the action of a process by its name, such as ``drive-1``."""
    return _matches(lambda details: bool(details["name"] == name))


def matches_executable(executable: str) -> Callable[[Any], bool]:
    """Return what recognises the actions of processes by the end of their program's path."""
    return _matches(lambda details: bool(details["cmd"][0].endswith(executable)))


class RunningProcessEvent(Event):
    """Something has happened to a process."""

    name = "launch.events.process.RunningProcessEvent"

    def __init__(self, *, action: Any, name: str, cmd: list[str], cwd: Any, env: Any, pid: int) -> None:
        self.action = action
        self.execute_process_action = action
        self.process_name = name
        self.cmd = cmd
        self.cwd = cwd
        self.env = env
        self.pid = pid


class ProcessStarted(RunningProcessEvent):
    """A process has started."""

    name = "launch.events.process.ProcessStarted"


class ProcessExited(RunningProcessEvent):
    """A process has ended."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A process has printed something; no such event is made here."""

    name = "launch.events.process.ProcessIO"

    def __init__(self, *, text: bytes, fd: int, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.text = text
        self.from_stdin, self.from_stdout, self.from_stderr = (fd == number for number in range(3))


class ProcessStdin(ProcessIO):
    """A process is given something to read."""

    name = "launch.events.process.ProcessStdin"

    def __init__(self, *, text: bytes, **kwargs: Any) -> None:
        super().__init__(text=text, fd=0, **kwargs)


class ProcessStdout(ProcessIO):
    """A process has printed something."""

    name = "launch.events.process.ProcessStdout"

    def __init__(self, *, text: bytes, **kwargs: Any) -> None:
        super().__init__(text=text, fd=1, **kwargs)


class ProcessStderr(ProcessIO):
    """A process has printed something as an error."""

    name = "launch.events.process.ProcessStderr"

    def __init__(self, *, text: bytes, **kwargs: Any) -> None:
        super().__init__(text=text, fd=2, **kwargs)


class ProcessTargetedEvent(Event):
    """Something is to be done to a process, which is not carried out here."""

    name = "launch.events.process.ProcessTargetedEvent"

    def __init__(self, *, process_matcher: Callable[[Any], bool]) -> None:
        self.process_matcher = process_matcher


class ShutdownProcess(ProcessTargetedEvent):
    """A process is to end."""

    name = "launch.events.process.ShutdownProcess"


class SignalProcess(ProcessTargetedEvent):
    """A process is to get a signal."""

    name = "launch.events.process.SignalProcess"

    def __init__(
        self, *, signal_number: str | signal.Signals, process_matcher: Callable[[Any], bool]
    ) -> None:
        super().__init__(process_matcher=process_matcher)
        if not isinstance(signal_number, (str, signal.Signals)):
            raise TypeError(
                f"'SignalProcess' expected 'signal_number' to be one of [{str}, {signal.Signals}], "
                f"but got '{signal_number}' of type '{type(signal_number)}'"
            )
        self.signal = signal_number

    @property
    def signal_name(self) -> str:
        """Such as ``SIGINT``."""
        return self.signal if isinstance(self.signal, str) else self.signal.name
