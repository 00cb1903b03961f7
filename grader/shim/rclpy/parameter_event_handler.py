"""Callbacks for changes of parameters, by parameter and node."""

from __future__ import annotations

from rclpy.qos import QoSProfile, qos_profile_parameter_events

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any

    from rclpy.callback_groups import CallbackGroup
    from rclpy.event_handler import SubscriptionEventCallbacks
    from rclpy.node import Node
    from rclpy.qos_overriding_options import QoSOverridingOptions

_UNKNOWN = "Callback doesn't exist"


class ParameterCallbackHandle:
    """Registration of a callback for one parameter of one node."""

    def __init__(self, parameter_name: str, node_name: str, callback: Callable[[Any], None]) -> None:
        self.parameter_name = parameter_name
        self.node_name = node_name
        self.callback = callback


class ParameterEventCallbackHandle:
    """Registration of a callback for all events."""

    def __init__(self, callback: Callable[[Any], None]) -> None:
        self.callback = callback


class ParameterEventHandler:
    """Calls back when parameters change, the callback that was added last first."""

    class Callbacks:
        """The callbacks of one handler."""

        def __init__(self) -> None:
            self.parameter_callbacks: dict[tuple[str, str], list[ParameterCallbackHandle]] = {}
            self.event_callbacks: list[ParameterEventCallbackHandle] = []

        def event_callback(self, event: Any) -> None:
            """Call what a rcl_interfaces/msg/ParameterEvent concerns."""
            for (name, node), handles in self.parameter_callbacks.items():
                found = ParameterEventHandler.get_parameter_from_event(event, name, node)
                if found:
                    for handle in handles:
                        handle.callback(found)
            for registered in self.event_callbacks:
                registered.callback(event)

        def add_parameter_callback(
            self, parameter_name: str, node_name: str, callback: Callable[[Any], None]
        ) -> ParameterCallbackHandle:
            """Add a callback for one parameter; the result removes it."""
            handle = ParameterCallbackHandle(parameter_name, node_name, callback)
            self.parameter_callbacks.setdefault((parameter_name, node_name), []).insert(0, handle)
            return handle

        def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
            """Undo `add_parameter_callback`; RuntimeError when that has happened already."""
            key = handle.parameter_name, handle.node_name
            handles = self.parameter_callbacks.get(key, [])
            if handle not in handles:
                raise RuntimeError(_UNKNOWN)
            handles.remove(handle)
            if not handles:
                del self.parameter_callbacks[key]

        def add_parameter_event_callback(
            self, callback: Callable[[Any], None]
        ) -> ParameterEventCallbackHandle:
            """Add a callback for all events; the result removes it."""
            handle = ParameterEventCallbackHandle(callback)
            self.event_callbacks.insert(0, handle)
            return handle

        def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
            """Undo `add_parameter_event_callback`; RuntimeError when that has happened already."""
            if handle not in self.event_callbacks:
                raise RuntimeError(_UNKNOWN)
            self.event_callbacks.remove(handle)

    def __init__(
        self,
        node: Node,
        qos_profile: QoSProfile = qos_profile_parameter_events,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> None:
        from rcl_interfaces.msg import ParameterEvent

        self.node = node
        self.qos_profile = qos_profile
        self._callbacks = ParameterEventHandler.Callbacks()
        self.parameter_event_subscription = node.create_subscription(
            ParameterEvent,
            "/parameter_events",
            self._callbacks.event_callback,
            qos_profile,
            callback_group=callback_group,
            event_callbacks=event_callbacks,
            qos_overriding_options=qos_overriding_options,
            raw=raw,
        )

    def destroy(self) -> None:
        """Call back no more."""
        self.node.destroy_subscription(self.parameter_event_subscription)

    @staticmethod
    def get_parameter_from_event(event: Any, parameter_name: str, node_name: str) -> Any:
        """Return the new rcl_interfaces/msg/Parameter of a node in an event, None when it is not in it."""
        if event.node != node_name:
            return None
        changed = ParameterEventHandler.get_parameters_from_event(event)
        return next((parameter for parameter in changed if parameter.name == parameter_name), None)

    @staticmethod
    def get_parameters_from_event(event: Any) -> Iterable[Any]:
        """Yield the new and the changed parameters of an event."""
        yield from event.new_parameters
        yield from event.changed_parameters

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[Any], None]
    ) -> ParameterCallbackHandle:
        """Have `callback` called with each new value of a parameter; keep the result to remove it."""
        path = self._resolve_path(node_name)
        return self._callbacks.add_parameter_callback(parameter_name, path, callback)

    def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
        """Undo `add_parameter_callback`; RuntimeError when that has happened already."""
        self._callbacks.remove_parameter_callback(handle)

    def add_parameter_event_callback(self, callback: Callable[[Any], None]) -> ParameterEventCallbackHandle:
        """Have `callback` called with each event; keep the result to remove it."""
        return self._callbacks.add_parameter_event_callback(callback)

    def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
        """Undo `add_parameter_event_callback`; RuntimeError when that has happened already."""
        self._callbacks.remove_parameter_event_callback(handle)

    def _resolve_path(self, node_path: str | None = None) -> str:
        """Return the full name of a node, that of this one by default."""
        if not node_path:
            return self.node.get_fully_qualified_name()
        if node_path.startswith("/"):
            return node_path
        resolved = "/".join((self.node.get_namespace().lstrip("/"), node_path))
        return resolved if resolved.startswith("/") else f"/{resolved}"
