"""A context can be used by ``with``."""

from __future__ import annotations

from rclpy import context
from rclpy._jazzy.overlay import extends

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

_humble_on_shutdown = context.Context.on_shutdown


@extends(context.Context)
class Context(context.Context):
    """Lifecycle of init and shutdown; an object serves once."""

    def destroy(self) -> None:
        """Destroy the handle, if there is one."""
        if self.handle is not None:
            self.handle.destroy_when_not_in_use()

    def on_shutdown(self, callback: Callable[[], Any]) -> None:
        """Have `callback` called at shutdown; methods are held weakly."""
        if self.handle is not None or not callable(callback):
            _humble_on_shutdown(self, callback)
        elif hasattr(callback, "__self__") and hasattr(callback, "__func__"):
            import weakref

            self._callbacks.append(weakref.WeakMethod(callback, self._remove_callback))
        else:
            self._callbacks.append(callback)

    def __enter__(self) -> Context:
        self.init()
        return self

    def __exit__(self, *_: object) -> None:
        self.try_shutdown()
