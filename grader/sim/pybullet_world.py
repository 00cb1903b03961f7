"""The world of a script that uses PyBullet: no turtle and no topics, only its recorded calls."""

from collections.abc import Callable, Sequence
from typing import Any

from grader.sim.feeds import Outbox
from grader.sim.frames import CarState, Entity, Request
from grader.sim.recorded_calls import RecordedCalls
from grader.sim.recorder import ReceivedCommands, Recorder


class PybulletWorld:
    """Takes calls and offers nothing. What they come to is found by a replay, after the run.

    Attributes:
        calls: what the script has recorded.
    """

    def __init__(self, recorder: Recorder, horizon_ns: int) -> None:
        self.outbox = Outbox()
        self.on_change: Callable[[frozenset[str]], None] = lambda topics: None
        self.services: dict[str, str] = {}
        self.carried: set[str] = set()
        self.received = ReceivedCommands(recorder)
        self.calls = RecordedCalls()
        self._recorder = recorder
        self._horizon_ns = horizon_ns

    @property
    def steps_run(self) -> int:
        """Steps of the simulation that the script has recorded."""
        return self.calls.steps

    def appear(self) -> None:
        """Record that nothing moves: the way that is scored comes from the replay."""
        self._recorder.sample(0, (0.0, 0.0, 0.0), 0.0, 0.0)

    def graph(self) -> dict[str, Any]:
        """Return START's ``world``: nothing."""
        return {"publishes": [], "subscribes": [], "services": [], "nodes": []}

    def type_of(self, topic: str) -> str | None:
        """Return None: the world neither publishes nor subscribes."""
        return None

    def misfit(self, entity: Entity) -> str | None:
        """Return None: nothing is offered."""
        return None

    def listen(self, topic: str, identity: int, t_ns: int, *, late: bool = False) -> None:
        """There is nothing to hear."""

    def command(
        self, topic: str, times_ns: Sequence[int], linear_x: float, linear_y: float, angular_z: float
    ) -> None:
        """There is no car."""

    def request(self, service: str, request: Request) -> bool:
        """Drop a request: the world has no services."""
        return False

    def forget_requests(self) -> None:
        """There are none."""

    def next_due(self) -> int | None:
        """Return None: nothing becomes due."""
        return None

    def let_reckon(self) -> CarState | None:
        """Return None: there is no car."""
        return None

    def take_back(self, t_ns: int) -> None:
        """Nothing is reckoned."""

    def advance(self, t_ns: int) -> None:
        """Do nothing: no car moves while the script runs."""

    def settle(self, from_ns: int, until_ns: int) -> int:
        """Return when the script ended: the simulation stops with it."""
        return min(from_ns, until_ns)

    def finish(self, end_ns: int) -> None:
        """Nothing is left to record."""

    def take(self, recorded: bytes) -> None:
        """Take the calls of one frame; ProtocolError."""
        self.calls.take(recorded, self._horizon_ns)
