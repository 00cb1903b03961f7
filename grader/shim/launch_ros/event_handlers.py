"""What is to be done when a node changes its state, of which launch is told nothing here."""

from __future__ import annotations

from launch import EventHandler
from launch._modules import offer

from launch_ros.events.lifecycle import StateTransition

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["OnStateTransition"]


class OnStateTransition(EventHandler):
    """Actions for a change of a node's state."""

    never = "OnStateTransition"

    def __init__(
        self,
        *,
        entities: Any,
        target_lifecycle_node: Any = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: Any = None,
        **options: Any,
    ) -> None:
        conditions = {"transition": transition, "start_state": start_state, "goal_state": goal_state}

        def matches(event: Any) -> bool:
            return (
                isinstance(event, StateTransition)
                and target_lifecycle_node in (None, event.action)
                and all(value in (None, getattr(event, name)) for name, value in conditions.items())
            )

        super().__init__(matcher=matcher or matches, entities=entities, **options)


offer(__name__)
