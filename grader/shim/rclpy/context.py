"""Contexts: what `rclpy.init` begins and `rclpy.shutdown` ends."""

from __future__ import annotations

import sys

from rclpy._forwarding import passed_on
from rclpy._kernel import kernel
from rclpy._rcl import logs
from rclpy._rcl.handles import ContextHandle, required

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

__getattr__ = passed_on(__name__)

g_logging_ref_count = 0


class Context:
    """Lifecycle of init and shutdown; an object serves once."""

    def __init__(self) -> None:
        self._callbacks: list[Callable[[], Any]] = []
        self._logging_initialized = False
        self.__context: ContextHandle | None = None

    @property
    def handle(self) -> ContextHandle | None:
        return self.__context

    def destroy(self) -> None:
        """Destroy the handle."""
        required(self.__context).destroy_when_not_in_use()

    def init(
        self, args: list[str] | None = None, *, initialize_logging: bool = True, domain_id: int | None = None
    ) -> None:
        """Initialise.

        `args` are those of the command line, by default `sys.argv`. `initialize_logging`: their log levels apply.

        Raises RuntimeError: the domain is negative, or the context was initialised before.
        """
        global g_logging_ref_count
        if domain_id is not None and domain_id < 0:
            raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
        if self.__context is not None:
            raise RuntimeError("Context.init() must only be called once")
        handle = ContextHandle(sys.argv if args is None else args, domain_id or 0)
        self.__context = handle
        if initialize_logging and not self._logging_initialized:
            g_logging_ref_count += 1
            if g_logging_ref_count == 1:
                logs.configure(handle.ros_args.levels, rosout=handle.ros_args.rosout)
            self._logging_initialized = True

    def _valid(self) -> bool:
        """Whether the context is initialised and not shut down, asked by the library itself."""
        return self.__context is not None and self.__context.valid

    def ok(self) -> bool:
        """Whether the context is initialised and not shut down."""
        kernel.charge()
        if self.__context is None:
            return False
        self.__context.require()
        return self.__context.valid

    def _call_on_shutdown_callbacks(self) -> None:
        for reference in self._callbacks:
            callback = reference()
            if callback is not None:
                callback()
        self._callbacks = []

    def shutdown(self) -> None:
        """Shut down; RuntimeError when never initialised, RCLError when shut down already."""
        if self.__context is None:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        self.__context.require()
        self.__context.shutdown()
        self._finish()

    def try_shutdown(self) -> None:
        """Shut down unless that has happened already."""
        if self.__context is not None and self.__context.valid:
            self.__context.shutdown()
            self._finish()

    def _finish(self) -> None:
        global g_logging_ref_count
        self._call_on_shutdown_callbacks()
        if self._logging_initialized:
            g_logging_ref_count -= 1
            if g_logging_ref_count == 0:
                logs.finish()
            self._logging_initialized = False

    def _remove_callback(self, weak_method: Any) -> None:
        if weak_method in self._callbacks:
            self._callbacks.remove(weak_method)

    def on_shutdown(self, callback: Callable[[], Any]) -> None:
        """Have `callback` called at shutdown; methods are held weakly.

        As upstream, a plain function is called once as if it were a weak reference and its result,
        when callable, once more.
        """
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        if not required(self.__context).valid:
            callback()
        elif hasattr(callback, "__self__") and hasattr(callback, "__func__"):
            import weakref

            self._callbacks.append(weakref.WeakMethod(callback, self._remove_callback))
        else:
            self._callbacks.append(callback)

    def get_domain_id(self) -> int:
        """Return the DDS domain; RuntimeError when not initialised."""
        if self.__context is None:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        return self.__context.get_domain_id()
