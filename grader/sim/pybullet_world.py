"""The world of a script that uses PyBullet: no turtle and no topics, only its recorded calls."""

from grader.sim.recorded_calls import RecordedCalls
from grader.sim.recorder import ReceivedCommands, Recorder
from grader.sim.simulated_world import SimulatedWorld


class PybulletWorld(SimulatedWorld):
    """Takes calls and offers nothing. What they come to is found by a replay, after the run.

    Attributes:
        calls: what the script has recorded.
    """

    def __init__(self, recorder: Recorder, horizon_ns: int) -> None:
        super().__init__(ReceivedCommands(recorder))  # none come: there is no car
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

    def settle(self, from_ns: int, until_ns: int) -> int:
        """Return when the script ended: the simulation stops with it."""
        return min(from_ns, until_ns)

    def take(self, recorded: bytes) -> None:
        """Take the calls of one frame; ProtocolError."""
        self.calls.take(recorded, self._horizon_ns)
