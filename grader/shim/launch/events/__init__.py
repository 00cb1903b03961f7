"""What happens while a description is carried out; names and arguments as launch's events have them."""

from __future__ import annotations

from launch._evaluation import Event, ExecutionComplete
from launch.events import process

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

__all__ = [
    "ExecutionComplete",
    "IncludeLaunchDescription",
    "Shutdown",
    "TimerEvent",
    "matches_action",
    "process",
]


def matches_action(target_action: Any) -> Callable[[Any], bool]:
    """Return what tells one action from all others."""
    return lambda action: bool(action == target_action)


class IncludeLaunchDescription(Event):
    """A description is to be carried out."""

    name = "launch.events.IncludeLaunchDescription"

    def __init__(self, launch_description: Any) -> None:
        self.launch_description = launch_description


class Shutdown(Event):
    """Everything is to end: each process gets Ctrl+C."""

    name = "launch.events.Shutdown"

    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason
        self.due_to_sigint = due_to_sigint


class TimerEvent(Event):
    """The time of a TimerAction has come; no such event is made here."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: Any) -> None:
        self.timer_action = timer_action
