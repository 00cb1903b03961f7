"""What starts a description outside of ``ros2 launch``, and what prints one: neither is possible here."""

from __future__ import annotations

from launch._evaluation import LaunchContext

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any


class LaunchService:
    """Takes descriptions as upstream's, and refuses to start what they describe."""

    def __init__(
        self, *, argv: Iterable[str] | None = None, noninteractive: bool = False, debug: bool = False
    ) -> None:
        self.context = LaunchContext(argv=argv, noninteractive=noninteractive)

    def include_launch_description(self, launch_description: Any) -> None:
        """Take a description."""

    def emit_event(self, event: Any) -> None:
        """Take an event."""

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Refuse. Raises NotImplementedError: always."""
        raise NotImplementedError(
            "LaunchService.run() starts processes, and none can be started here: "
            "hand in the package with the launch file, which is then launched as by ros2 launch"
        )

    async def run_async(self, *, shutdown_when_idle: bool = True) -> int:
        """Refuse. Raises NotImplementedError: always."""
        return self.run(shutdown_when_idle=shutdown_when_idle)

    def shutdown(self, force_sync: bool = False) -> None:
        """End nothing: nothing has been started."""


class LaunchIntrospector:
    """Refuses to print descriptions."""

    def format_launch_description(self, launch_description: Any) -> str:
        """Refuse. Raises NotImplementedError: always."""
        raise NotImplementedError("descriptions are not printed here")
