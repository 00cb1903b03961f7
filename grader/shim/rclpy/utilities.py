"""The default context and other things of the process as a whole."""

from __future__ import annotations

import sys

from rclpy.constants import S_TO_NS
from rclpy.context import Context

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

g_default_context: Context | None = None

_RMW = "rmw_fastrtps_cpp"


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context used where none is given; the next caller gets a fresh one after `shutting_down`."""
    global g_default_context
    context = g_default_context
    if context is None:
        context = g_default_context = Context()
    if shutting_down:
        g_default_context = None
    return context


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return the command line (default `sys.argv`) without the arguments for ROS."""
    from rclpy._rcl.ros_args import remove_ros_args as strip

    return strip(sys.argv if args is None else args)


def ok(*, context: Context | None = None) -> bool:
    """Whether the context (default: the default one) is initialised and not shut down."""
    return (get_default_context() if context is None else context).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut a context down; RuntimeError when it was never initialised, RCLError when done already."""
    if context is None:
        context = get_default_context(shutting_down=True)
    context.shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down unless that has happened already; never raises."""
    global g_default_context
    if context is not None:
        context.try_shutdown()
        return
    context = get_default_context()
    context.try_shutdown()
    if not context._valid():
        g_default_context = None


def get_rmw_implementation_identifier() -> str:
    """Return the name of the middleware."""
    return _RMW


def get_available_rmw_implementations() -> set[str]:
    """Return the names of the installed middlewares."""
    return {_RMW}


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Return nanoseconds of a timeout, -1 for one that never ends (None or negative)."""
    if timeout_sec is None or timeout_sec < 0:
        return -1
    return int(float(timeout_sec) * S_TO_NS)
