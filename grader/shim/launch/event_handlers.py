"""When a process starts or ends. Only its start is known here; a command counts as ended at once."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class _Handler:
    """Actions for one event of one process, or of all."""

    def __init__(self, target_action: Any, actions: Any) -> None:
        self.target_action = target_action
        self.actions = actions if isinstance(actions, (list, tuple)) or callable(actions) else [actions]


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
