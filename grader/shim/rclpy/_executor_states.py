"""What an executor's wait can end with, besides something that is ready."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType

    from rclpy.executors import Executor


class TimeoutException(Exception):
    """A wait timed out."""

    __module__ = "rclpy.executors"


class ShutdownException(Exception):
    """The executor was shut down."""

    __module__ = "rclpy.executors"


class ExternalShutdownException(Exception):
    """The context was shut down from elsewhere."""

    __module__ = "rclpy.executors"


class ConditionReachedException(Exception):
    """The future waited for is done."""

    __module__ = "rclpy.executors"


class TimeoutObject:
    """A timeout that its owner updates between waits."""

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout

    @property
    def timeout(self) -> float:
        return self._timeout

    @timeout.setter
    def timeout(self, timeout: float) -> None:
        self._timeout = timeout


class Spinning:
    """While inside, an executor waits for ever by nature: an idle node is no deadlock."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def __enter__(self) -> None:
        self._executor._spinning += 1

    def __exit__(
        self, t: type[BaseException] | None, v: BaseException | None, tb: TracebackType | None
    ) -> None:
        self._executor._spinning -= 1
