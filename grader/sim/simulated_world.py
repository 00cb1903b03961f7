"""What every world offers to the episode."""

from collections.abc import Callable, Sequence
from typing import Any

from grader.contracts.conversation import TurtleSample
from grader.contracts.trajectory import Trajectory
from grader.sim.feeds import Outbox
from grader.sim.frames import CarState, Entity, Request
from grader.sim.recorder import ReceivedCommands


class SimulatedWorld:
    """Everything that is not the script, in virtual time. Instants never decrease from call to call.

    This one offers nothing: worlds derive from it, and define what they have.

    Attributes:
        outbox: what is due for the script, and who hears what.
        on_change: called with the topics that came or went.
        services: types by name.
        carried: every topic on which commands were taken at any time.
        received: the commands that came for what is graded.
    """

    def __init__(self, received: ReceivedCommands, *command_topics: str) -> None:
        self.received = received
        self.outbox = Outbox()
        self.on_change: Callable[[frozenset[str]], None] = lambda topics: None
        self.services: dict[str, str] = {}
        self.carried = set(command_topics)

    @property
    def steps_run(self) -> int:
        """Physics steps computed."""
        raise NotImplementedError

    def appear(self) -> None:
        """Build the physical world. To be called first, once; InfrastructureError."""

    def graph(self) -> dict[str, Any]:
        """Return START's ``world``: what exists besides the script, from the world's point of view."""
        return {"publishes": [], "subscribes": [], "services": [], "nodes": []}

    def type_of(self, topic: str) -> str | None:
        """Return the type the world publishes or subscribes to on `topic`, None when it does neither."""
        return None

    def qos_note(self, entity: Entity) -> str | None:
        """Return the note on a subscription whose QoS the world's publisher on its topic does not offer."""
        return None

    def listen(self, topic: str, identity: int, t_ns: int, *, late: bool = False) -> None:
        """Connect subscription `identity` to `topic`, which the world publishes, from `t_ns` on.

        `late`: it is TRANSIENT_LOCAL, and wants what is kept for those who come late.
        """

    def command(
        self, topic: str, times_ns: Sequence[int], linear_x: float, linear_y: float, angular_z: float
    ) -> None:
        """Take a message on a command topic, which was published at each of these times in order."""

    def say(self, topic: str, t_ns: int, payload: bytes) -> None:
        """Publish a message of a conversation: to the script, and to what takes commands on the topic."""
        self.outbox.publish(topic, t_ns, payload)

    def turtles(self, t_ns: int) -> dict[str, TurtleSample]:
        """Return where the turtles of turtlesim's window are at `t_ns`, by name."""
        return {}

    def request(self, service: str, request: Request) -> bool:
        """Queue a request to one of `services`; false when too many wait."""
        return False

    def forget_requests(self) -> None:
        """Drop every waiting request: a script that broke the protocol is served no more."""

    def next_due(self) -> int | None:
        """Return the next instant at which something may become due for the script, None when never."""
        return None

    def let_reckon(self) -> CarState | None:
        """Return what the script needs to compute the poses itself; None unless only its commands decide them."""
        return None

    def take_back(self, t_ns: int) -> None:
        """Publish again what comes after `t_ns`, and is not to be reckoned any more."""

    def advance(self, t_ns: int) -> None:
        """Run until `t_ns`."""

    def settle(self, from_ns: int, until_ns: int) -> int:
        """Run the world on without the script until the car rests; return when that is."""
        raise NotImplementedError

    def as_commanded(self, recorded: Trajectory) -> Trajectory | None:
        """Return the motion if each command had been obeyed at once; None where none waited."""
        return None

    def finish(self, end_ns: int) -> None:
        """Drive up to `end_ns`, when the episode ended, and record the last sample."""
