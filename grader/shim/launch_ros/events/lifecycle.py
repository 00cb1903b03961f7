"""Events about nodes with states. None of them is carried out, or ever comes, here."""

from __future__ import annotations

from launch import Event
from launch._modules import offer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

__all__ = ["ChangeState", "StateTransition", "matches_node_name"]


def matches_node_name(node_name: str) -> Callable[[Any], bool]:
    """Return what recognises the action of a node by its name, with the namespace in front."""
    full_name = node_name if node_name.startswith("/") else f"/{node_name}"
    return lambda action: bool(action.node_name == full_name)


class ChangeState(Event):
    """A node is to change its state."""

    name = "launch_ros.events.lifecycle.ChangeState"
    untold = True

    def __init__(self, *, lifecycle_node_matcher: Callable[[Any], bool], transition_id: int) -> None:
        self.lifecycle_node_matcher = lifecycle_node_matcher
        self.transition_id = transition_id


class StateTransition(Event):
    """A node has changed its state."""

    name = "launch_ros.events.lifecycle.StateTransition"

    def __init__(self, *, action: Any, msg: Any) -> None:
        self.action = action
        self.msg = msg
        self.transition = msg.transition.label
        self.start_state = msg.start_state.label
        self.goal_state = msg.goal_state.label


offer(__name__, matches_node_name="lifecycle_node_matchers")
