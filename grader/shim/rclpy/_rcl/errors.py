"""Exceptions that upstream's C module defines; tracebacks must name that module."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeVar

    ClassT = TypeVar("ClassT", bound=type)

_MODULE = "rclpy._rclpy_pybind11"


class RCUtilsError(RuntimeError):
    """A failure of the C utility layer."""

    __module__ = _MODULE


class RMWError(RuntimeError):
    """A failure of the middleware layer."""

    __module__ = _MODULE


class RCLError(RuntimeError):
    """A failure of the ROS client library; its text ends in file and line as Humble prints them."""

    __module__ = _MODULE


class RCLInvalidROSArgsError(RCLError):
    """A ROS argument after ``--ros-args`` cannot be parsed."""

    __module__ = _MODULE


class UnknownROSArgsError(RuntimeError):
    """An argument after ``--ros-args`` is not a ROS argument."""

    __module__ = _MODULE


class NodeNameNonExistentError(RCLError):
    """A graph query names a node that does not exist."""

    __module__ = _MODULE


class UnsupportedEventTypeError(RCLError):
    """The middleware does not support a QoS event."""

    __module__ = _MODULE


class NativeNotImplementedError(RuntimeError):
    """The C module's own NotImplementedError."""

    __module__ = _MODULE
    __qualname__ = __name__ = "NotImplementedError"


class InvalidHandle(RuntimeError):
    """A handle is used after its destruction was requested."""

    __module__ = _MODULE


def wrong_arguments(function: str, signature: str, *given: object) -> TypeError:
    """Return what pybind11 raises for arguments that a function of the C module does not take."""
    what = "constructor" if function == "__init__" else "function"
    return TypeError(
        f"{function}(): incompatible {what} arguments. The following argument types are supported:\n"
        f"    1. {signature}\n\nInvoked with: {', '.join(map(repr, given))}"
    )


def native(name: str) -> Callable[[ClassT], ClassT]:
    """Name a class as the class of the C module that it stands for."""

    def rename(cls: ClassT) -> ClassT:
        cls.__module__, cls.__name__, cls.__qualname__ = _MODULE, name, name
        return cls

    return rename


def text_or_null(value: object, refusal: Callable[[], TypeError]) -> str | None:
    """Return what C gets as a text: None is a null pointer, and bytes are taken as they are."""
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    raise refusal()


DESTROYED = "cannot use Destroyable because destruction was requested"
PUBLISHER_CONTEXT = "publisher's context is invalid, at ./src/rcl/publisher.c:389"
SHUTDOWN_TWICE = (
    "failed to shutdown: rcl_shutdown already called on the given context, at ./src/rcl/init.c:241"
)
NO_TOPIC_NAME = "input_topic_name argument is null, at ./src/rcl/expand_topic_name.c:60"
_NOT_VALID = (
    "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called., at "
)
GUARD_CONTEXT = _NOT_VALID + "./src/rcl/guard_condition.c:67"
WAIT_CONTEXT = _NOT_VALID + "./src/rcl/wait.c:130"
NODE_CONTEXT = "rcl node's context is invalid, at ./src/rcl/node.c:428"
NEGATIVE_PERIOD = "failed to create timer: timer period must be non-negative, at ./src/rcl/timer.c:139"
TIMER_CANCELED = "failed to call timer: timer is canceled, at ./src/rcl/timer.c:249"
