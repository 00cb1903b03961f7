"""ROS client library for Python, as of ROS 2 Humble, in virtual time.

The names and their behaviour are those of upstream's rclpy; what a script notices of the difference is
listed in docs/fidelity.md.
"""

from __future__ import annotations

from rclpy._interfaces import importer as _importer  # noqa: F401 - makes the interface packages importable
from rclpy.context import Context as Context
from rclpy.parameter import Parameter as Parameter
from rclpy.signals import SignalHandlerOptions as SignalHandlerOptions
from rclpy.signals import install_signal_handlers, uninstall_signal_handlers
from rclpy.task import Future as Future
from rclpy.utilities import get_default_context as get_default_context
from rclpy.utilities import get_rmw_implementation_identifier as get_rmw_implementation_identifier
from rclpy.utilities import ok as ok
from rclpy.utilities import shutdown as _shutdown
from rclpy.utilities import try_shutdown as try_shutdown

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy.executors import Executor
    from rclpy.node import Node


def init(
    *,
    args: list[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> None:
    """Initialise a context.

    Args:
        args: command line, default `sys.argv`.
        context: default: the default one.
        domain_id: DDS domain.
        signal_handler_options: which signals to take over; all for the default context, else none.

    Raises:
        RuntimeError: the context was initialised before. UnknownROSArgsError: see the class.
    """
    context = get_default_context() if context is None else context
    if signal_handler_options is None:
        default = context is get_default_context()
        signal_handler_options = SignalHandlerOptions.ALL if default else SignalHandlerOptions.NO
    context.init(args, domain_id=domain_id)
    install_signal_handlers(signal_handler_options)


_executor: Executor | None = None


def get_global_executor() -> Executor:
    """Return the executor that the spin functions use when they are given none."""
    global _executor
    if _executor is None:
        from rclpy.executors import SingleThreadedExecutor

        created = SingleThreadedExecutor()

        def reset_executor() -> None:
            global _executor
            if _executor is not None:
                _executor.shutdown()
            _executor = None

        _executor = created
        get_default_context().on_shutdown(reset_executor)
    return _executor


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut a context (default: the default one) and its executor down.

    Raises RuntimeError: it was never initialised. RCLError: it is shut down already.
    """
    _shutdown(context=context)
    if uninstall_handlers or (
        uninstall_handlers is None and (context is None or context is get_default_context())
    ):
        uninstall_signal_handlers()


def create_node(
    node_name: str,
    *,
    context: Context | None = None,
    cli_args: list[str] | None = None,
    namespace: str | None = None,
    use_global_arguments: bool = True,
    enable_rosout: bool = True,
    start_parameter_services: bool = True,
    parameter_overrides: list[Parameter] | None = None,
    allow_undeclared_parameters: bool = False,
    automatically_declare_parameters_from_overrides: bool = False,
) -> Node:
    """Create a `rclpy.node.Node`; the arguments are described there."""
    from rclpy.node import Node

    return Node(
        node_name,
        context=context,
        cli_args=cli_args,
        namespace=namespace,
        use_global_arguments=use_global_arguments,
        enable_rosout=enable_rosout,
        start_parameter_services=start_parameter_services,
        parameter_overrides=parameter_overrides,
        allow_undeclared_parameters=allow_undeclared_parameters,
        automatically_declare_parameters_from_overrides=automatically_declare_parameters_from_overrides,
    )


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Wait for one callback and run it; the timeout None or negative blocks, 0 does not."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        executor.spin_once(timeout_sec=timeout_sec)
    finally:
        executor.remove_node(node)


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run callbacks until the context is shut down."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        executor._spin_while_valid()
    finally:
        executor.remove_node(node)


def spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run callbacks until the future is done or the timeout (None or negative: never) has passed."""
    executor = get_global_executor() if executor is None else executor
    added = False
    try:
        added = executor.add_node(node)
        executor.spin_until_future_complete(future, timeout_sec)
    finally:
        if added:
            executor.remove_node(node)


_WITH_RCLPY = ("exceptions", "impl")
_WITH_NODE = (
    "callback_groups",
    "client",
    "clock",
    "duration",
    "executors",
    "expand_topic_name",
    "logging",
    "parameter_service",
    "publisher",
    "qos",
    "qos_event",
    "qos_overriding_options",
    "service",
    "subscription",
    "time",
    "time_source",
    "timer",
    "topic_endpoint_info",
    "type_support",
    "validate_full_topic_name",
    "validate_namespace",
    "validate_node_name",
    "validate_parameter_name",
    "validate_topic_name",
    "waitable",
)
"""Submodules that upstream imports on the way to `rclpy` and `rclpy.node`, so that scripts may rely on them."""


def __getattr__(name: str) -> Any:
    """Import a submodule that is an attribute of upstream's package already."""
    import sys

    submodules = _WITH_RCLPY + (_WITH_NODE if "rclpy.node" in sys.modules else ())
    if name in submodules:
        from importlib import import_module

        return import_module(f"rclpy.{name}")
    from rclpy._forwarding import passed_on

    found = passed_on(__name__)(name)
    return [*found, *submodules] if name == "__all__" else found
