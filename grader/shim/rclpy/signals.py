"""What happens to the node's context when a signal arrives."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy._kernel import kernel
from rclpy._rcl.enums import SignalHandlerOptions as SignalHandlerOptions
from rclpy._rcl.errors import wrong_arguments
from rclpy._rcl.handles import shutdown_all_contexts
from rclpy.guard_condition import GuardCondition

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rclpy.context import Context

__getattr__ = passed_on(__name__)

_installed = SignalHandlerOptions.NO
_registered = False


def _on_ctrl_c() -> None:
    """Every context is shut down before KeyboardInterrupt is raised."""
    if _installed in (SignalHandlerOptions.ALL, SignalHandlerOptions.SIGINT):
        shutdown_all_contexts()


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Take over the signals named by `options`."""
    global _installed, _registered
    if not isinstance(options, SignalHandlerOptions):
        signature = "(arg0: rclpy::SignalHandlerOptions) -> None"
        raise wrong_arguments("install_signal_handlers", signature, options)
    _installed = options
    takes_sigterm = options in (SignalHandlerOptions.ALL, SignalHandlerOptions.SIGTERM)
    kernel.on_terminate = shutdown_all_contexts if takes_sigterm else None
    if options is not SignalHandlerOptions.NO and not _registered:
        _registered = True
        kernel.on_interrupt(_on_ctrl_c)


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Return which signals are taken over."""
    return _installed


def uninstall_signal_handlers() -> None:
    """Leave all signals to Python again."""
    global _installed
    _installed = SignalHandlerOptions.NO
    kernel.on_terminate = None


class SignalHandlerGuardCondition(GuardCondition):
    """A guard condition that a signal triggers; blocked waits end by KeyboardInterrupt here."""

    def __init__(self, context: Context | None = None) -> None:
        super().__init__(callback=None, callback_group=None, context=context)
