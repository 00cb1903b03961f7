"""Clients and servers of actions log under names of their own."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any


def change_client(module: ModuleType) -> None:
    """Have the clients of `rclpy.action.client` log as ``<node>.action_client``."""
    _name_loggers(module.ActionClient, "action_client")


def change_server(module: ModuleType) -> None:
    """Have the servers of `rclpy.action.server` log as ``<node>.action_server``."""
    _name_loggers(module.ActionServer, "action_server")


def _name_loggers(cls: Any, name: str) -> None:
    humble_init = cls.__init__

    def __init__(self: Any, *args: Any, **kwargs: Any) -> None:  # noqa: N807 - it becomes the class's own
        humble_init(self, *args, **kwargs)
        self._logger = self._node.get_logger().get_child(name)

    __init__.__qualname__ = humble_init.__qualname__
    cls.__init__ = __init__
