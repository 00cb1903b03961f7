"""One episode: the script's frames and the simulated world in lockstep, from START to the last sample."""

import hashlib
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from grader.contracts.assignment import EPOCH_NS, Distro, InterfaceDefinition, RunsAs, World
from grader.contracts.conversation import Conversation, Expectation, Step, sayings
from grader.contracts.errors import ProtocolError
from grader.contracts.grading import WorldRequest
from grader.contracts.outcome import Endpoint, LogRecord, Note
from grader.contracts.record import Record
from grader.contracts.trajectory import Trajectory
from grader.sim import frames
from grader.sim.car import NS_PER_S, UPDATE_NS, UPDATE_S
from grader.sim.cdr import HEADER
from grader.sim.cdr import decode as read
from grader.sim.driving import Car
from grader.sim.recorder import LOG, Journal, ReceivedCommands, Recorder
from grader.sim.script_graph import ScriptGraph
from grader.sim.simulated_world import SimulatedWorld
from grader.sim.turtle import Turtle
from grader.sim.turtle_world import TWIST, TurtleWorld
from grader.sim.wire import PROTOCOL, decode, encode_events, encode_start

if TYPE_CHECKING:
    from grader.contracts.replay import Replayed
    from grader.sim.conversation import Talk
    from grader.sim.pybullet_world import PybulletWorld
    from grader.sim.recorded_calls import RecordedCalls
    from grader.sim.robot_body import RobotBody
    from grader.sim.robot_world import RobotWorld

ROSOUT: Final = "/rosout"
AHEAD_NS: Final = 100_000_000
"""A script that has gone this long without ADVANCE runs ahead. One that subscribes sends it every 16 ms."""
MAX_FACTS_BYTES: Final = 1 << 20  # the tree of 3,000 nodes has some 200 KB
MAX_REQUESTS: Final = 200  # whose values are kept
MAX_DRIVERS: Final = 50
"""A script with more publishers that the world takes from, those of /rosout included, asks for each pose."""
NEVER_NS: Final = 1 << 62

_TWIST: Final = struct.Struct("<4s6d")


_CONTESTED: Final = 20  # more changes from a drive to a turn than any figure has
_LONGEST_VALUES: Final = 200
LONG_WAIT_UPDATES: Final = 3
"""A command that waits for so many updates is told of: motions last 0.05 s longer. Fewer are chance."""
WAIT_NOTE: Final = "commands_wait"
"""Commands came faster than updates: how many a second, and for how many seconds one waited at most."""


class EpisodeSpec(Record):
    """Everything an episode depends on besides the script's behaviour.

    Attributes:
        horizon_ns: virtual instant of Ctrl+C; the car is not moved beyond it.
        source: the student's file. file_name: its name, for tracebacks.
        facts: whether the script is traced, to explain its marks.
        package: START's field for a package; `source` then holds its files one after the other. None: a script.
        args: of the command line, without the file. stdin: text for `input()`.
        said: what is said to the script. expectations: what is wanted of it.
        interfaces: what the script can import besides ROS's own.
        output_bytes: what the script may print before the shim ends it; None: no bound.
        steps: what it may do before the shim ends it (`Limits.steps`); None: no bound.
        distro: release of ROS 2 that script and world are of. runs_as: how the script is started.
    """

    world: World
    horizon_ns: int
    source: bytes
    file_name: str
    args: tuple[str, ...] = ()
    stdin: str = ""
    said: tuple[Step, ...] = ()
    expectations: tuple[Expectation, ...] = ()
    interfaces: tuple[InterfaceDefinition, ...] = ()
    output_bytes: int | None = None
    steps: int | None = None
    distro: Distro = "humble"
    runs_as: RunsAs = "python"
    package: Mapping[str, Any] | None = None
    facts: bool = False


class EpisodeResult(Record):
    """What the episode saw. The sandbox's report says the rest (signals, limits, streams).

    Attributes:
        exit: the script's own account of its end; None: the process ended without one.
        violation: one sentence on how the process broke the wire format, after which nothing was believed.
        duration_ns: virtual time at which the script ended, at most the horizon.
        sim_steps: physics steps computed.
        most_steps: what the script was allowed to do.
        requests: the first calls of the world's services.
        recorded: the script's calls of PyBullet; None: it is of another world.
        replayed: what became of these, once they were replayed.
        tree, ledger: of a traced run, as they came. The tree was written before the script's first line ran.
        heard: whether the process sent a frame; its first one comes before any code of the script runs.
    """

    trajectory: Trajectory
    exit: frames.Exit | None
    violation: str | None
    duration_ns: int
    nodes: tuple[str, ...]
    endpoints: tuple[Endpoint, ...]
    logs: tuple[LogRecord, ...]
    logs_dropped: int
    notes: tuple[Note, ...]
    command_count: int
    nonfinite_commands: int
    first_command_ns: int | None
    last_command_ns: int | None
    sim_steps: int
    conversation: Conversation | None = None
    most_steps: int | None = None
    requests: tuple[WorldRequest, ...] = ()
    recorded: "RecordedCalls | None" = None
    replayed: "Replayed | None" = None
    tree: bytes = b""
    ledger: bytes = b""
    heard: bool = True


class Episode:
    """Runs one script's episode on `car`, which any number of episodes may use one after the other.

    In the robot's world it is run on what `robot` returns, which is not called in turtlesim's.
    """

    def __init__(self, spec: EpisodeSpec, car: Car, robot: "Callable[[], RobotBody] | None" = None) -> None:
        self._spec = spec
        self._recorder = Recorder()
        self._world: SimulatedWorld
        self._bullet: PybulletWorld | None = None
        if spec.world.kind == "pybullet":
            self._world = self._bullet = _pybullet_world(self._recorder, spec.horizon_ns)
        elif spec.world.kind == "robot":
            self._world = _robot_world(robot, self._recorder, spec)
        else:
            turtle = Turtle(car, self._recorder, spec.world, spec.horizon_ns)
            self._world = TurtleWorld(turtle, spec.world, EPOCH_NS, spec.distro)
        self._world.on_change = self._reconnect
        self._graph = ScriptGraph()
        self._journal = Journal()
        self._talk = _talk(spec, self._world, self._graph) if spec.said or spec.expectations else None
        self._sinks: dict[int, Callable[[Sequence[int], bytes], None]] = {}
        # the last one, as long as only its REPEATs have followed
        self._published: frames.Publish | None = None
        self._now_ns = 0
        self._requests: list[WorldRequest] = []
        self._in_turn_ns: int | None = None  # of the last ADVANCE, while script and world take turns
        self._exit: frames.Exit | None = None
        self._has_started = False
        self._may_have_run = False
        self._facts = {frames.TREE: b"", frames.LEDGER: b""}

    @property
    def now_ns(self) -> int:
        """Virtual time that script and world have reached."""
        return self._now_ns

    def run(
        self,
        link: frames.Link,
        meanwhile: Callable[[], None] = lambda: None,
        on_note: Callable[[str], None] = lambda code: None,
        take_turns: Callable[[bool], None] = lambda in_turns: None,
    ) -> EpisodeResult:
        """Drive the episode until the script has ended and the car has come to rest, or the horizon.

        `meanwhile` is called once, while the script is compiled, `on_note` with the code of each NOTE. At the
        beginning, and when script and world begin or cease to wait for each other, `take_turns` is called with
        whether they do.

        Raises InfrastructureError: the simulator failed. Nothing that the jailed process does raises.
        """
        violation = None
        self._on_note = on_note
        self._take_turns = take_turns
        try:
            link.send(encode_start(self._start_fields(), self._spec.source))
            self._world.appear()
            meanwhile()
            take_turns(False)
            while self._exit is None and (body := link.receive()) is not None:
                self._take(decode(body), link)
                self._has_started = True
        except ProtocolError as error:
            violation = str(error)
        return self._finish(violation)

    def _start_fields(self) -> dict[str, Any]:
        spec = self._spec
        return {
            **({} if spec.package is None else {"package": spec.package}),
            **({"facts": True} if spec.facts else {}),
            **({} if spec.runs_as == "python" else {"runs_as": spec.runs_as}),
            "protocol": PROTOCOL,
            "file_name": spec.file_name,
            "args": list(spec.args),
            "stdin": spec.stdin,
            "horizon_ns": spec.horizon_ns,
            "epoch_ns": EPOCH_NS,
            "seed": self._script_seed(),
            "distro": spec.distro,
            "output_bytes": spec.output_bytes,
            "steps": spec.steps,
            "interfaces": [interface.lines for interface in spec.interfaces],
            "world": self._start_world(),
        }

    def _start_world(self) -> dict[str, Any]:
        """Return what exists besides the script: the car's world, and what is said to the script."""
        world = self._world.graph()
        world["calls"] = []
        if self._talk is not None:
            self._talk.add_to(world)
        return world

    def _script_seed(self) -> int:
        """Return the seed of the script's randomness: not that of the rough noise, which it could foresee."""
        if self._spec.world.profile == "rough":
            return int.from_bytes(hashlib.sha256(self._spec.source).digest()[:4], "big")
        return self._spec.world.seed

    def _take(self, frame: frames.Frame, link: frames.Link) -> None:
        """Act on one frame; its time must not be earlier than that of the one before."""
        if isinstance(frame, frames.Publish):
            self._published = frame
            self._publish(*frame)
        elif isinstance(frame, frames.Repeat):
            self._repeat(frame)
        else:
            self._published = None
            self._take_other(frame, link)

    def _take_other(self, frame: frames.RareFrame, link: frames.Link) -> None:
        if isinstance(frame, frames.NoteFrame):
            self._note(frame)
        elif isinstance(frame, frames.Advance):
            self._check_time(frame.t_ns)
            self._advance(frame, link)
        elif isinstance(frame, frames.CallsFrame):
            self._take_calls(frame)
        elif isinstance(frame, frames.Facts):
            self._take_facts(frame)
        else:
            self._pass_time(frame.t_ns)
            if isinstance(frame, frames.Exit):
                # A syntax error costs no attempt, so a script that has run must not be able to claim one.
                if frame.reason == frames.SYNTAX_ERROR and self._has_started:
                    raise ProtocolError("EXIT.reason is a syntax error, but the script had started")
                self._exit = frame
            elif frame.t_ns <= self._spec.horizon_ns:
                self._graph_change(frame)

    def _note(self, frame: frames.NoteFrame) -> None:
        if frame.code == frames.STARTED_NOTE:  # from now on, frames may be the script's own
            self._may_have_run = True
            return
        self._on_note(frame.code)
        if frame.code == frames.THREADS_NOTE:  # says nothing of how the script drives
            return
        better = Note(code="sensor_qos", text=frame.text)  # the script cannot tell a sensor from other topics
        if frame.code != "incompatible_qos" or better not in self._journal.notes:
            self._journal.note(frame.code, frame.text)

    def _take_calls(self, frame: frames.CallsFrame) -> None:
        self._pass_time(frame.t_ns)
        if self._bullet is None:
            raise ProtocolError("CALLS came in a world without PyBullet")
        self._bullet.take(frame.recorded)

    def _take_facts(self, frame: frames.Facts) -> None:
        """Keep a piece of the tree, until the script runs, or of the ledger."""
        if not self._spec.facts or (frame.what == frames.TREE and self._may_have_run):
            raise ProtocolError("FACTS.what came where nobody asked for it")
        self._facts[frame.what] += frame.piece
        if len(self._facts[frame.what]) > MAX_FACTS_BYTES:
            raise ProtocolError(f"FACTS has more than {MAX_FACTS_BYTES} bytes")

    def _publish(self, identity: int, t_ns: int, payload: bytes) -> None:
        self._pass_time(t_ns)
        if t_ns > self._now_ns:  # beyond the horizon
            return
        entity = self._graph.get(identity, frames.PUBLISHER)
        if self._talk is not None:
            self._talk.hear(entity, (t_ns,), payload)
        if sink := self._sinks.get(identity):
            sink((t_ns,), payload)

    def _repeat(self, frame: frames.Repeat) -> None:
        """Take a message that was published again and again, with nothing else between."""
        identity, times_ns = frame
        if self._published is None or self._published.id != identity:
            raise ProtocolError("REPEAT.id is not that of the frame before")
        if list(times_ns) != sorted(times_ns):
            raise ProtocolError("REPEAT.times go back")
        payload = self._published.payload
        self._check_time(times_ns[0])
        self._pass_time(times_ns[-1])
        if not (taken := _up_to(self._spec.horizon_ns, times_ns)):
            return
        entity = self._graph.get(identity, frames.PUBLISHER, uses=len(taken))
        if self._talk is not None:
            self._talk.hear(entity, taken, payload)
        if sink := self._sinks.get(identity):
            sink(taken, payload)

    def _pass_time(self, t_ns: int) -> None:
        """Advance the world to `t_ns`. What a script does after Ctrl+C happens at the horizon, like its EXIT."""
        self._check_time(t_ns)
        if self._talk is not None:
            self._go_on(self._talk, min(t_ns, self._spec.horizon_ns))
        self._now_ns = min(t_ns, self._spec.horizon_ns)
        if self._in_turn_ns is not None and self._now_ns - self._in_turn_ns > AHEAD_NS:
            self._in_turn_ns = None
            self._take_turns(False)

    def _go_on(self, talk: "Talk", t_ns: int) -> None:
        """Let the conversation go on up to `t_ns`, the time that a script which runs ahead has reached."""
        while (due_ns := self._said_next(talk)) is not None and due_ns <= t_ns:
            self._world.advance(due_ns)
            talk.run(due_ns)

    def _said_next(self, talk: "Talk") -> int | None:
        """Return when the conversation goes on; at once where what a step waited for has come."""
        due_ns = talk.next_ns()
        return None if due_ns is None else max(due_ns, self._now_ns)

    def _check_time(self, t_ns: int) -> None:
        if t_ns < self._now_ns:
            raise ProtocolError(f"time went back from {self._now_ns} to {t_ns} ns")

    def _graph_change(self, frame: frames.Entity | frames.Gone | frames.Request | frames.Response) -> None:
        self._world.take_back(frame.t_ns)
        if isinstance(frame, frames.Entity):
            self._graph.add(frame)
            self._connect(frame)
            if self._talk is not None:
                self._talk.meet(frame)
        elif isinstance(frame, frames.Gone):
            self._graph.remove(frame.id)
            if self._talk is not None:
                self._talk.part(frame.id, frame.t_ns)
            self._sinks.pop(frame.id, None)
            self._world.outbox.unsubscribe(frame.id)
        elif isinstance(frame, frames.Request):
            self._request(self._graph.get(frame.id, frames.CLIENT), frame)
        else:
            self._graph.get(frame.id, frames.SERVICE)
            if self._talk is None:
                raise ProtocolError(f"RESPONSE.sequence {frame.sequence} was never asked")
            self._talk.answer(frame)

    def _request(self, client: frames.Entity, frame: frames.Request) -> None:
        """Hand a request to the world, if it offers the service."""
        if self._talk is not None and self._talk.request(client, frame):
            return
        if self._world.services.get(client.name) != client.type:
            return
        if len(self._requests) < MAX_REQUESTS:
            values = _request_text(client.type, frame.payload)
            if values is not None:
                self._requests.append(WorldRequest(t_ns=frame.t_ns, service=client.name, values=values))
        if not self._world.request(client.name, frame):
            self._journal.note("too_many_requests", client.name)

    def _connect(self, entity: frames.Entity) -> None:
        """Connect a publisher or subscription with the world where topic, type and QoS agree."""
        if (entity.what, entity.name, entity.type) == (frames.PUBLISHER, ROSOUT, LOG):
            self._sinks[entity.id] = self._log
            return
        kind = (
            self._world.type_of(entity.name)
            if entity.what in (frames.PUBLISHER, frames.SUBSCRIPTION)
            else None
        )
        if kind is None or (kind == TWIST) != (entity.what == frames.PUBLISHER):
            return
        if entity.type != kind:
            self._journal.note("type_mismatch", entity.name)
        elif entity.what == frames.PUBLISHER and entity.reliable:
            self._sinks[entity.id] = partial(self._command, entity.name)
        elif entity.what == frames.PUBLISHER:
            self._journal.note("incompatible_qos", entity.name)
        elif (note := self._world.qos_note(entity)) is not None:
            self._journal.note(note, entity.name)
        else:
            self._world.listen(entity.name, entity.id, entity.t_ns, late=entity.transient_local)

    def _reconnect(self, topics: frozenset[str]) -> None:
        """Connect what the script has on `topics` anew: a turtle has come or gone."""
        for entity in self._graph.on(topics):
            self._sinks.pop(entity.id, None)
            self._world.outbox.unsubscribe(entity.id)
            self._connect(entity)

    def _log(self, times_ns: Sequence[int], payload: bytes) -> None:
        """Take a log record; bytes that are not one are dropped, as in `_command`."""
        try:
            for t_ns in times_ns:
                self._journal.log(t_ns, payload)
        except ProtocolError:
            self._journal.note("unreadable_message", ROSOUT)

    def _command(self, topic: str, times_ns: Sequence[int], payload: bytes) -> None:
        """Take a Twist. A script may publish raw bytes; those that are not a Twist are dropped, as DDS does."""
        if len(payload) != _TWIST.size or payload[:4] != HEADER:
            self._journal.note("unreadable_message", topic)
            return
        _, x, y, _, _, _, turn = _TWIST.unpack(payload)
        self._world.command(topic, times_ns, x, y, turn)

    def _advance(self, frame: frames.Advance, link: frames.Link) -> None:
        """Answer ADVANCE: run to the first instant at which something is due, or as far as is asked."""
        outbox, t_ns = self._world.outbox, frame.t_ns
        self._world.take_back(self._now_ns)
        limit_ns = min(t_ns, self._spec.horizon_ns)
        together_ns = min(frame.together_ns, limit_ns)
        while together_ns > self._now_ns and not self._run_to_next(together_ns):
            if outbox.full:
                together_ns = outbox.last_ns  # what comes later is due in the next answer
        while not outbox and not self._run_to_next(limit_ns):
            pass
        due_ns, events = outbox.take(together_ns) if outbox else (t_ns, [])
        # What became due while the script was computing is sent with the present time, not one in its past.
        self._now_ns = min(max(due_ns, self._now_ns), t_ns)
        left_ns = outbox.first_ns
        quiet_ns = self._next_due() if left_ns is None else left_ns
        car = self._let_reckon()
        if car is None:
            if self._in_turn_ns is None:
                self._take_turns(True)
            self._in_turn_ns = self._now_ns
        link.send(encode_events(self._now_ns, quiet_ns, events, car))

    def _let_reckon(self) -> frames.CarState | None:
        """Return what the script needs to compute the poses itself; None if anything else may become due."""
        must_ask = self._talk is not None or len(self._sinks) > MAX_DRIVERS
        car = None if must_ask else self._world.let_reckon()
        if car is None:
            return None
        drivers = tuple(identity for identity, sink in self._sinks.items() if sink != self._log)
        return car._replace(publishers=drivers)

    def _next_due(self) -> int:
        """Return the next instant at which something may become due, whatever is commanded until then."""
        world_ns = self._world.next_due()
        talk_ns = None if self._talk is None else self._said_next(self._talk)
        if world_ns is None or (talk_ns is not None and talk_ns < world_ns):
            return NEVER_NS if talk_ns is None else talk_ns
        return world_ns

    def _run_to_next(self, limit_ns: int) -> bool:
        """Run to the next instant at which something may be due; true when that is the limit."""
        now_ns = min(limit_ns, self._next_due())
        self._world.advance(now_ns)
        if self._talk is not None:
            self._talk.run(now_ns)
        return now_ns >= limit_ns

    def _finish(self, violation: str | None) -> EpisodeResult:
        received, journal = self._world.received, self._journal
        noted = any(note.code == frames.INTERRUPTED_NOTE for note in journal.notes)
        if noted if self._exit is None else self._exit.after_interrupt:
            self._now_ns = self._spec.horizon_ns  # Ctrl+C comes there, whenever a script says it came
        end_ns, violation = self._come_to_rest(violation)
        self._world.finish(end_ns)
        conversation = None if self._talk is None else self._talk.result()
        said = (
            () if conversation is None else sayings(conversation, {step.id: step for step in self._spec.said})
        )
        trajectory = self._recorder.finish(end_ns)
        commanded = self._world.as_commanded(trajectory)
        trajectory = replace(trajectory, sayings=said, commanded=commanded)
        self._note_motion(trajectory)
        return EpisodeResult(
            trajectory=trajectory,
            exit=self._exit,
            violation=violation,
            duration_ns=min(self._now_ns, self._spec.horizon_ns),
            nodes=self._graph.nodes(),
            endpoints=self._graph.endpoints(frozenset(self._world.carried)),
            logs=journal.logs,
            logs_dropped=journal.logs_dropped,
            notes=journal.notes,
            command_count=received.count,
            nonfinite_commands=received.nonfinite,
            first_command_ns=received.first_ns,
            last_command_ns=received.last_ns,
            sim_steps=self._world.steps_run,
            conversation=conversation,
            most_steps=self._spec.steps,
            requests=tuple(self._requests),
            recorded=None if self._bullet is None else self._bullet.calls,
            tree=self._facts[frames.TREE],
            ledger=self._facts[frames.LEDGER],
            heard=self._has_started,
        )

    def _note_motion(self, trajectory: Trajectory) -> None:
        """Note what is worth telling of the commands and of what the car met."""
        received, journal = self._world.received, self._journal
        for contact in trajectory.contacts:
            journal.note("wall", contact.wall)
        for code in _seen_in(received, trajectory):
            journal.note(code)
        if trajectory.commanded is not None and received.longest_wait >= LONG_WAIT_UPDATES:
            rate_hz = received.count / len(trajectory.commands) * (NS_PER_S / UPDATE_NS)
            journal.note(WAIT_NOTE, f"{rate_hz:.0f}|{received.longest_wait * UPDATE_S:.2f}")
        if received.clamped:
            journal.note("clamped_robot" if self._spec.world.kind == "robot" else "clamped_command")

    def _come_to_rest(self, violation: str | None) -> tuple[int, str | None]:
        """Run the world on without the script; return when it rests, and the violation until then, if any."""
        horizon_ns = self._spec.horizon_ns
        if violation is None:
            try:
                return self._world.settle(self._now_ns, horizon_ns), None
            except ProtocolError as error:
                violation = str(error)
        self._world.forget_requests()
        return self._world.settle(self._now_ns, horizon_ns), violation


def _robot_world(
    robot: "Callable[[], RobotBody] | None", recorder: Recorder, spec: EpisodeSpec
) -> "RobotWorld":
    from grader.sim.robot_body import RobotBody  # of the extra "physics"
    from grader.sim.robot_world import RobotWorld

    return RobotWorld((robot or RobotBody)(), recorder, spec.world, spec.horizon_ns)


def _pybullet_world(recorder: Recorder, horizon_ns: int) -> "PybulletWorld":
    from grader.sim.pybullet_world import PybulletWorld  # only its own scripts need it

    return PybulletWorld(recorder, horizon_ns)


def _talk(spec: EpisodeSpec, world: SimulatedWorld, graph: ScriptGraph) -> "Talk":
    from grader.sim.conversation import Plan, Talk  # only scripts that are spoken to need it

    seed = f"{spec.world.seed}/{hashlib.sha256(spec.source).hexdigest()}"
    return Talk(Plan(spec.said, spec.expectations, spec.interfaces, seed), world, graph)


def _seen_in(received: ReceivedCommands, trajectory: Trajectory) -> Iterator[str]:
    """Yield the codes of the notes on commands that the car could not, or hardly, follow."""
    if received.lateral:
        yield "lateral_command"
    if received.motions and not any(command.v_mps or command.w_radps for command in trajectory.commands):
        yield "stopped_at_once"
    if received.contested >= _CONTESTED:
        yield "contested"


def _up_to(horizon_ns: int, times_ns: Sequence[int]) -> Sequence[int]:
    """Return the times that are not beyond the horizon."""
    return times_ns if times_ns[-1] <= horizon_ns else [t_ns for t_ns in times_ns if t_ns <= horizon_ns]


def _request_text(service_type: str, payload: bytes) -> str | None:
    """Return a request's fields as the script wrote them; None of a request that is no call of the student's.

    Of an action, only the goal is; asking for its result and its state is rclpy's own doing.
    """
    if service_type.endswith(("_GetResult", "_CancelGoal")) or service_type.startswith("rcl_interfaces/"):
        return None
    try:
        values = read(f"{service_type}_Request", payload)
    except ProtocolError:  # the world finds it, too, when it serves the request
        return None
    shown = ", ".join(f"{name}={_written(value)}" for name, value in values.get("goal", values).items())
    return shown[:_LONGEST_VALUES]


def _written(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else repr(value)  # a float32 has six digits
