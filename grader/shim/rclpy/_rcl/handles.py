"""Handles: the objects upstream keeps in C, with their rules of use and destruction."""

from __future__ import annotations

from rclpy._kernel import kernel
from rclpy._rcl.errors import (
    DESTROYED,
    GUARD_CONTEXT,
    SHUTDOWN_TWICE,
    InvalidHandle,
    RCLError,
    native,
    wrong_arguments,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from rclpy._rcl.ros_args import RosArgs


class Changes:
    """What tells an executor that it has to look at its nodes' entities anew.

    Attributes:
        count: grows whenever an entity is created or destroyed, or a timer may be due sooner than it said.
        additions: how many of these changes only added an entity.
        executing: entities whose callbacks an executor has given out, and have not ended. Their groups may keep
            others waiting.
    """

    def __init__(self) -> None:
        self.count = 0
        self.additions = 0
        self.executing: list[Any] = []

    def given_out(self) -> tuple[tuple[int, bool], ...]:
        """Return what decides, besides `count`, which entities may execute.

        That is which callbacks run, and whether each has taken its data.
        """
        return tuple((id(entity), entity._executor_event) for entity in self.executing)


changes = Changes()


class Handle:
    """Something destroyed on request, but not before its last user has left its ``with`` block.

    Attributes:
        doomed: destruction was requested; entering raises InvalidHandle from then on.
    """

    def __init__(self) -> None:
        changes.count += 1
        changes.additions += 1
        self.doomed = False
        self._users = 0

    @property
    def pointer(self) -> int:
        """Identity of the handle as an integer."""
        return id(self)

    def __enter__(self) -> None:
        if self.doomed:
            raise InvalidHandle(DESTROYED)
        self._users += 1

    def __exit__(self, *_: object) -> None:
        self._users -= 1
        if self.doomed and not self._users:
            self._dispose()

    def destroy_when_not_in_use(self) -> None:
        """Forbid further use and dispose as soon as nobody is inside; a second request does nothing."""
        if self.doomed:
            return
        changes.count += 1
        self.doomed = True
        if not self._users:
            self._dispose()

    def require(self) -> None:
        """Raise InvalidHandle when destruction was requested."""
        if self.doomed:
            raise InvalidHandle(DESTROYED)

    def _dispose(self) -> None:
        """Release what the handle holds; called once."""


@native("Context")
class ContextHandle(Handle):
    """Life of one `rclpy.init`.

    Attributes:
        valid: initialised and not shut down.
        ros_args: what followed ``--ros-args``. program: the one of a launch that it belongs to.
    """

    def __init__(self, args: Sequence[str], domain_id: int) -> None:
        super().__init__()
        from rclpy._rcl.ros_args import parse_ros_args

        if not isinstance(args, list):
            signature = "rclpy._rclpy_pybind11.Context(arg0: list, arg1: int)"
            raise wrong_arguments("__init__", signature, args, domain_id or 2**64 - 1)
        self.ros_args: RosArgs = parse_ros_args(args, reject_unknown=True)
        self.domain_id = domain_id
        self.valid = True
        self.program = kernel.running.program
        _live_contexts.append(self)

    def ok(self) -> bool:
        """Whether the context has not been shut down."""
        return self.valid

    def get_domain_id(self) -> int:
        """Return the DDS domain: nodes of different domains do not see each other.

        Raises RCLError: the context is shut down.
        """
        if not self.valid:
            raise RCLError("Failed to get domain id: error not set")
        return self.domain_id

    def shutdown(self) -> None:
        """Invalidate the context; RCLError when that has happened already."""
        if self in _live_contexts:
            _live_contexts.remove(self)
        if not self.valid:
            raise RCLError(SHUTDOWN_TWICE)
        self.valid = False


_live_contexts: list[ContextHandle] = []


def shutdown_all_contexts() -> None:
    """What upstream's signal handler does: invalidate every context, calling no Python callback."""
    for context in list(_live_contexts):
        context.shutdown()


def required(handle: ContextHandle | None) -> ContextHandle:
    """Return the handle of an initialised context.

    Raises AttributeError: there is none; Humble's Python enters ``with None`` and fails with this text.
    """
    if handle is None:
        raise AttributeError("__enter__")
    handle.require()
    return handle


class GuardHandle(Handle):
    """Something a thread can trigger to wake an executor.

    Attributes:
        backlog: non-empty while triggered and not yet seen by a wait.
    """

    def __init__(self, context: ContextHandle) -> None:
        super().__init__()
        if not required(context).valid:
            raise RCLError(f"failed to create guard_condition: {GUARD_CONTEXT}")
        self.backlog: list[bool] = []

    def trigger_guard_condition(self) -> None:
        """Wake whoever waits on this guard, or the next one who does."""
        if not self.backlog:
            self.backlog.append(True)
