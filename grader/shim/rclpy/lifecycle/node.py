"""Managed nodes."""

from __future__ import annotations

from collections import namedtuple

from rclpy._forwarding import passed_on
from rclpy._interfaces import own
from rclpy._rcl.errors import RCLError
from rclpy.lifecycle._machine import LifecycleStateMachine
from rclpy.lifecycle._machine import TransitionCallbackReturnType as TransitionCallbackReturn
from rclpy.lifecycle.managed_entity import ManagedEntity
from rclpy.lifecycle.publisher import LifecyclePublisher
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service import Service

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy.callback_groups import CallbackGroup

    Callback = Callable[[Any], TransitionCallbackReturn]

__getattr__ = passed_on(__name__)

LifecycleState = namedtuple("LifecycleState", ("label", "state_id"))

_SHUTDOWNS = {"unconfigured": 5, "inactive": 6, "active": 7}


class LifecycleNodeMixin(ManagedEntity):
    """What makes a node a managed one; to be initialised after `Node`."""

    def __init__(
        self, *, enable_communication_interface: bool = True, callback_group: CallbackGroup | None = None
    ) -> None:
        self._callbacks: dict[int, Callback] = {
            10: self.on_configure,
            11: self.on_cleanup,
            12: self.on_shutdown,
            13: self.on_activate,
            14: self.on_deactivate,
            15: self.on_error,
        }
        self._managed_entities: dict[ManagedEntity, None] = {}
        node: Any = self
        group = node.default_callback_group if callback_group is None else callback_group
        node.handle.require()
        self._state_machine = LifecycleStateMachine(node.handle, enable_communication_interface)
        if enable_communication_interface:
            for name, kind, callback in (
                ("change_state", own.ChangeState, self.__on_change_state),
                ("get_state", own.GetState, self.__on_get_state),
                ("get_available_states", own.GetAvailableStates, self.__on_get_available_states),
                (
                    "get_available_transitions",
                    own.GetAvailableTransitions,
                    self.__on_get_available_transitions,
                ),
                (
                    "get_transition_graph",
                    own.GetAvailableTransitions,
                    self.__on_get_transition_graph,
                ),
            ):
                handle = getattr(self._state_machine, f"service_{name}")
                qos = QoSProfile(**handle.qos.to_dict())
                service = Service(handle, kind, handle.name, callback, group, qos)
                setattr(self, f"_service_{name}", service)
                group.add_entity(service)
                node._services.append(service)

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Configure the node; RCLError when its state does not allow it."""
        return self.__change_state(1)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Undo the configuration; RCLError when the state does not allow it."""
        return self.__change_state(2)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Shut the node down; RCLError when the state does not allow it."""
        transition = _SHUTDOWNS.get(self._state_machine.current_state[1])
        if transition is None:
            raise RCLError("Shutdown transtion not possible")
        return self.__change_state(transition)

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Activate the node; RCLError when its state does not allow it."""
        return self.__change_state(3)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Deactivate the node; RCLError when its state does not allow it."""
        return self.__change_state(4)

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Have an entity follow the node's transitions; TypeError unless it is a ManagedEntity."""
        if not isinstance(entity, ManagedEntity):
            raise TypeError("Expected a rclpy.lifecycle.ManagedEntity instance.")
        self._managed_entities[entity] = None

    def __follow(self, callback_name: str, state: Any) -> TransitionCallbackReturn:
        for entity in self._managed_entities:
            answer = getattr(entity, callback_name)(state)
            if not isinstance(answer, TransitionCallbackReturn):
                raise TypeError(
                    f"{callback_name}() return value of class {type(entity)} should be"
                    " `TransitionCallbackReturn`.\n"
                    f"Instance of the class that caused the failure: {entity}"
                )
            if answer != TransitionCallbackReturn.SUCCESS:
                return answer
        return TransitionCallbackReturn.SUCCESS

    def on_configure(self, state: Any) -> TransitionCallbackReturn:
        """Configure the managed entities."""
        return self.__follow("on_configure", state)

    def on_cleanup(self, state: Any) -> TransitionCallbackReturn:
        """Clean the managed entities up."""
        return self.__follow("on_cleanup", state)

    def on_shutdown(self, state: Any) -> TransitionCallbackReturn:
        """Shut the managed entities down."""
        return self.__follow("on_shutdown", state)

    def on_activate(self, state: Any) -> TransitionCallbackReturn:
        """Activate the managed entities."""
        return self.__follow("on_activate", state)

    def on_deactivate(self, state: Any) -> TransitionCallbackReturn:
        """Deactivate the managed entities."""
        return self.__follow("on_deactivate", state)

    def on_error(self, state: Any) -> TransitionCallbackReturn:
        """Tell the managed entities of an error."""
        return self.__follow("on_error", state)

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> Any:
        """Create a publisher that is silent while the node is not active; see `Node.create_publisher`."""
        if "publisher_class" in kwargs:
            raise TypeError("create_publisher() got an unexpected keyword argument 'publisher_class'")
        node: Any = self
        publisher: Any = Node.create_publisher(node, *args, **kwargs, publisher_class=LifecyclePublisher)
        self._managed_entities[publisher] = None
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        """Destroy a publisher of this node; whether it was one."""
        self._managed_entities.pop(publisher, None)
        node: Any = self
        return Node.destroy_publisher(node, publisher)

    def __execute_callback(self, previous_state: Any) -> TransitionCallbackReturn:
        callback = self._callbacks.get(self._state_machine.current_state[0])
        if callback is None:
            return TransitionCallbackReturn.SUCCESS
        try:
            return callback(previous_state)
        except Exception:
            return TransitionCallbackReturn.ERROR

    def __change_state(self, transition_id: int) -> TransitionCallbackReturn:
        ident, label = self._state_machine.current_state
        initial = LifecycleState(state_id=ident, label=label)
        self._state_machine.trigger_transition_by_id(transition_id, True)
        answer = self.__execute_callback(initial)
        self._state_machine.trigger_transition_by_label(answer.to_label(), True)
        if answer == TransitionCallbackReturn.ERROR:
            recovered = self.__execute_callback(initial)
            self._state_machine.trigger_transition_by_label(recovered.to_label(), True)
        return answer

    def __on_change_state(self, req: Any, resp: Any) -> Any:
        transition_id = req.transition.id
        if req.transition.label:
            try:
                transition_id = self._state_machine.get_transition_by_label(req.transition.label)
            except RCLError:
                resp.success = False
                return resp
        resp.success = self.__change_state(transition_id) == TransitionCallbackReturn.SUCCESS
        return resp

    def __on_get_state(self, req: Any, resp: Any) -> Any:
        resp.current_state.id, resp.current_state.label = self._state_machine.current_state
        return resp

    def __on_get_available_states(self, req: Any, resp: Any) -> Any:
        for ident, label in self._state_machine.available_states:
            resp.available_states.append(own.State(id=ident, label=label))
        return resp

    def __on_get_available_transitions(self, req: Any, resp: Any) -> Any:
        return _describe(self._state_machine.available_transitions, resp)

    def __on_get_transition_graph(self, req: Any, resp: Any) -> Any:
        return _describe(self._state_machine.transition_graph, resp)


def _describe(transitions: list[tuple[int, str, int, str, int, str]], resp: Any) -> Any:
    for ident, label, start, start_label, goal, goal_label in transitions:
        item = own.TransitionDescription()
        item.transition.id, item.transition.label = ident, label
        item.start_state.id, item.start_state.label = start, start_label
        item.goal_state.id, item.goal_state.label = goal, goal_label
        resp.available_transitions.append(item)
    return resp


class LifecycleNode(LifecycleNodeMixin, Node):
    """A node that is managed from outside; `Node`'s arguments apply."""

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)
