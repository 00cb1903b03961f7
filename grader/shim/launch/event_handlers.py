"""When a process starts or ends. A command, which is not run here, counts as ended at once."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class _Handler:
    """Actions for one event of one process, or of all."""

    def __init__(self, target_action: Any, actions: Any) -> None:
        self.target_action = target_action
        self.actions = actions if isinstance(actions, (list, tuple)) or callable(actions) else [actions]

    def is_about(self, action: Any) -> bool:
        """Whether it is to be done for the process of this action."""
        if callable(self.target_action):
            return bool(self.target_action(action))
        return self.target_action is None or self.target_action is action


class OnProcessStart(_Handler):
    """Actions for the start of a process."""

    def __init__(self, *, target_action: Any = None, on_start: Any = (), **_: Any) -> None:
        super().__init__(target_action, on_start)


class OnProcessExit(_Handler):
    """Actions for the end of a process."""

    def __init__(self, *, target_action: Any = None, on_exit: Any = (), **_: Any) -> None:
        super().__init__(target_action, on_exit)


class OnShutdown(_Handler):
    """Actions for the end of everything, which never comes here."""

    def __init__(self, *, on_shutdown: Any = (), **_: Any) -> None:
        super().__init__(None, on_shutdown)


class ProcessEvent:
    """What a function that gives the actions is told: which process, and how it ended."""

    def __init__(self, action: Any, returncode: int) -> None:
        self.action = action
        self.returncode = returncode
