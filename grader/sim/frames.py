"""What travels between the jailed process and the episode, as data. The byte form is `grader.sim.wire`."""

from typing import NamedTuple, Protocol, TypeAlias

NODE, PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT = 1, 2, 3, 4, 5
FINISHED, EXCEPTION, STALLED, SYNTAX_ERROR, PRINTED_TOO_MUCH, TOO_MANY_STEPS = 0, 1, 2, 3, 4, 5
TREE, LEDGER = 1, 2
MESSAGE_EVENT, RESPONSE_EVENT, REQUEST_EVENT, GRAPH_EVENT = 1, 2, 3, 4

APART = 1 << 20
"""Ids from here on are of others than the jailed process, whose own are two bytes long."""

INTERRUPTED_NOTE = "interrupted"
"""Sent by the shim when the horizon's Ctrl+C is raised."""

STARTED_NOTE = "started"
"""Sent by the shim when the script has been compiled, before any of its code runs."""

THREADS_NOTE = "threads"
"""Sent by the shim when the script starts its first thread. Only one of its threads runs at a time."""


class Link(Protocol):
    """The channel to the jailed process, in whole frame bodies."""

    def send(self, body: bytes) -> None:
        """Send one frame. A process that is gone is not an error: `receive` will tell."""

    def receive(self) -> bytes | None:
        """Wait for the next frame; None when the process has ended."""


class Entity(NamedTuple):
    """The script created a node, publisher, subscription, service or client."""

    id: int
    what: int
    t_ns: int
    node: str
    name: str
    type: str
    reliable: bool
    transient_local: bool
    depth: int


class Gone(NamedTuple):
    """The script destroyed an entity."""

    id: int
    t_ns: int


class Publish(NamedTuple):
    """A message; `payload` is CDR, or empty where the world does not listen."""

    id: int
    t_ns: int
    payload: bytes


class Repeat(NamedTuple):
    """The message of the PUBLISH before was published again at these times."""

    id: int
    times_ns: tuple[int, ...]


class Request(NamedTuple):
    """A request to a service of the world."""

    id: int
    sequence: int
    t_ns: int
    payload: bytes


class Response(NamedTuple):
    """An answer of one of the script's services to a request of the episode."""

    id: int
    sequence: int
    t_ns: int
    payload: bytes


class Advance(NamedTuple):
    """Nothing earlier than `t_ns` will come; what is due first up to then?

    Everything that is due up to `together_ns` travels in one answer: nobody looks at it one by one.
    """

    t_ns: int
    together_ns: int


class NoteFrame(NamedTuple):
    """Something the shim found worth telling the student."""

    code: str
    text: str


class CallsFrame(NamedTuple):
    """Calls of PyBullet that the script has made up to `t_ns`; `recorded` is read by `recorded_calls`."""

    t_ns: int
    recorded: bytes


class Facts(NamedTuple):
    """A piece of what a traced run tells of its script: of its tree, or of its ledger."""

    what: int
    piece: bytes


class Exit(NamedTuple):
    """How the script ended. `reason` is one of FINISHED ... TOO_MANY_STEPS."""

    t_ns: int
    reason: int
    after_interrupt: bool
    exit_code: int
    exception_type: str
    message: str
    line: int
    detail: str


RareFrame: TypeAlias = Entity | Gone | Request | Response | Advance | NoteFrame | CallsFrame | Facts | Exit
Frame: TypeAlias = Publish | Repeat | RareFrame


class Event(NamedTuple):
    """Something due for the jail. `what` is one of MESSAGE_EVENT ... GRAPH_EVENT."""

    what: int
    id: int
    sequence: int
    t_ns: int
    payload: bytes


class CarState(NamedTuple):
    """All that the poses of the nominal car depend on, until the script does more than drive.

    Attributes:
        subscriptions: ids that hear the poses, in the order in which they do.
        publishers: ids whose messages are commands.
        t_ns: instant of the last update; the rest is as it left it.
        velocity: (v, w) in that update. commanded: (v, w) from the next one on, until `drop_ns`.
        waiting: (v, w) of the commands of which each update takes one, in order.
        resting: whether updates would change nothing.
        window_m: width and height of the window, whose walls hold the car; 0: it has none.
    """

    subscriptions: tuple[int, ...]
    publishers: tuple[int, ...]
    t_ns: int
    pose: tuple[float, float, float]
    velocity: tuple[float, float]
    commanded: tuple[float, float]
    waiting: tuple[tuple[float, float], ...]
    drop_ns: int
    resting: bool
    window_m: float
