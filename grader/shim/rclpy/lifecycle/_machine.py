"""The state machine of managed nodes (rcl_lifecycle/default_state_machine.c)."""

from __future__ import annotations

from rclpy._interfaces import own
from rclpy._rcl import logs
from rclpy._rcl.endpoints import PublisherHandle
from rclpy._rcl.enums import NativeEnum
from rclpy._rcl.errors import RCLError
from rclpy._rcl.qos import NativeQos
from rclpy._rcl.service_endpoints import ServiceHandle

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rclpy._rcl.node_handle import NodeHandle

STATES = {
    0: "unknown",
    1: "unconfigured",
    2: "inactive",
    3: "active",
    4: "finalized",
    10: "configuring",
    11: "cleaningup",
    12: "shuttingdown",
    13: "activating",
    14: "deactivating",
    15: "errorprocessing",
}

SUCCESS, FAILURE, ERROR = "transition_success", "transition_failure", "transition_error"

TRANSITIONS = (
    (1, "configure", 1, 10),
    (10, SUCCESS, 10, 2),
    (11, FAILURE, 10, 1),
    (12, ERROR, 10, 15),
    (2, "cleanup", 2, 11),
    (20, SUCCESS, 11, 1),
    (21, FAILURE, 11, 2),
    (22, ERROR, 11, 15),
    (3, "activate", 2, 13),
    (30, SUCCESS, 13, 3),
    (31, FAILURE, 13, 2),
    (32, ERROR, 13, 15),
    (4, "deactivate", 3, 14),
    (40, SUCCESS, 14, 2),
    (41, FAILURE, 14, 3),
    (42, ERROR, 14, 15),
    (5, "shutdown", 1, 12),
    (6, "shutdown", 2, 12),
    (7, "shutdown", 3, 12),
    (50, SUCCESS, 12, 4),
    (51, FAILURE, 12, 4),
    (52, ERROR, 12, 15),
    (60, SUCCESS, 15, 1),
    (61, FAILURE, 15, 4),
    (62, ERROR, 15, 4),
)
"""(id, label, start state, goal state)."""

_NOT_REGISTERED = (
    "Failed to trigger lifecycle state machine transition: Transition is not registered., at "
    "./src/rcl_lifecycle.c:355"
)


class TransitionCallbackReturnType(NativeEnum):
    """What a transition's callback says."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99

    def to_label(self) -> str:
        """Return the label of the transition that follows."""
        return {97: SUCCESS, 98: FAILURE, 99: ERROR}[self.value]


class LifecycleStateMachine:
    """State of one managed node, with its services and its topic of transitions when wanted."""

    def __init__(self, node: NodeHandle, enable_com_interface: bool) -> None:
        if not isinstance(enable_com_interface, bool):
            raise TypeError("__init__(): incompatible constructor arguments.")
        self._state = 1
        self.initialized = True
        self._events: PublisherHandle | None = None
        self.service_change_state: ServiceHandle | None = None
        self.service_get_state: ServiceHandle | None = None
        self.service_get_available_states: ServiceHandle | None = None
        self.service_get_available_transitions: ServiceHandle | None = None
        self.service_get_transition_graph: ServiceHandle | None = None
        if enable_com_interface:
            qos = NativeQos.predefined("qos_profile_default")
            self._events = PublisherHandle(node, own.TransitionEvent, "~/transition_event", qos)
            transitions = own.GetAvailableTransitions
            for name, kind in (
                ("change_state", own.ChangeState),
                ("get_state", own.GetState),
                ("get_available_states", own.GetAvailableStates),
                ("get_available_transitions", transitions),
                ("get_transition_graph", transitions),
            ):
                services = NativeQos.predefined("qos_profile_services_default")
                setattr(self, f"service_{name}", ServiceHandle(node, kind, f"~/{name}", services))

    @property
    def current_state(self) -> tuple[int, str]:
        """Id and label of the state."""
        return self._state, STATES[self._state]

    @property
    def available_states(self) -> list[tuple[int, str]]:
        """Ids and labels of all states."""
        return list(STATES.items())

    @property
    def available_transitions(self) -> list[tuple[int, str, int, str, int, str]]:
        """Transitions possible now, described as in `transition_graph`."""
        return [described for described in self.transition_graph if described[2] == self._state]

    @property
    def transition_graph(self) -> list[tuple[int, str, int, str, int, str]]:
        """All transitions: id, label, start id and label, goal id and label."""
        return [
            (ident, label, start, STATES[start], goal, STATES[goal])
            for ident, label, start, goal in TRANSITIONS
        ]

    def get_transition_by_label(self, label: str) -> int:
        """Return the id of the transition of that label possible now; RCLError when there is none."""
        for ident, known, start, _ in TRANSITIONS:
            if known == label and start == self._state:
                return ident
        self._warn_of(label)
        raise RCLError("Failed to get transition from label: error not set")

    def trigger_transition_by_id(self, transition_id: int, publish_update: bool) -> None:
        """Make a transition; RCLError when it is not possible now."""
        for ident, label, start, goal in TRANSITIONS:
            if ident == transition_id and start == self._state:
                self._move(ident, label, goal, publish_update)
                return
        self._warn_of(transition_id)
        raise RCLError(_NOT_REGISTERED)

    def trigger_transition_by_label(self, label: str, publish_update: bool) -> None:
        """Make a transition; RCLError when it is not possible now."""
        for ident, known, start, goal in TRANSITIONS:
            if known == label and start == self._state:
                self._move(ident, label, goal, publish_update)
                return
        self._warn_of(label)
        raise RCLError(_NOT_REGISTERED)

    def _warn_of(self, transition: int | str) -> None:
        """Log what rcl_lifecycle_get_transition_by_id and by_label log (rcl_lifecycle.c:318 and :339)."""
        text = f"No transition matching {transition} found for current state {STATES[self._state]}"
        logs.warn("rcl_lifecycle", text)

    def _move(self, ident: int, label: str, goal: int, publish_update: bool) -> None:
        start, self._state = self._state, goal
        if publish_update and self._events is not None:
            message = own.TransitionEvent()
            message.transition.id = ident
            message.transition.label = label
            message.start_state.id = start
            message.start_state.label = STATES[start]
            message.goal_state.id = goal
            message.goal_state.label = STATES[goal]
            try:
                self._events.publish(message)
            except RCLError as error:
                cause = str(error).removeprefix("Failed to publish: ")
                text = f"Could not publish transition: {cause}, at ./src/rcl_lifecycle.c:368"
                raise RCLError(f"Failed to trigger lifecycle state machine transition: {text}") from None
