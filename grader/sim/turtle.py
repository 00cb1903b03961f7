"""A turtle, and turtlesim's rules for what is commanded to it."""

import math
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Final

from grader.contracts.assignment import WINDOW_M, World
from grader.contracts.trajectory import COMMAND_LIFE_NS, Command, Trajectory
from grader.sim.car import UPDATE_NS, PlanarPose, clamp_command, next_update
from grader.sim.driving import Car
from grader.sim.frames import CarState
from grader.sim.recorder import ReceivedCommands, Recorder, Unrecorded

_NEVER: Final = 1 << 62
_LIFE_UPDATES: Final = COMMAND_LIFE_NS // UPDATE_NS
_LIFE_NS: Final = (_LIFE_UPDATES + 1) * UPDATE_NS - 1
"""From the update that takes a command until it is dropped. An instant on an update itself would be too late: a
command is taken by the update after it."""
MOST_WAITING: Final = 7
"""Commands that wait for a turtle (`KeepLast(7)` in turtle.cpp)."""
MOST_DEEDS: Final = 50_000  # a turn by the action is one in each update
_LAG_NS: Final = 100_000_000
"""How far the car may lag behind while commands only repeat the present one. Driving in larger pieces costs less;
0.1 s is small enough for the car to drive while the script computes, instead of after it."""


class Inbox:
    """The commands that wait for a turtle. Each update takes one, oldest first; an eighth pushes the oldest out.

    turtlesim's updates call `rclcpp::spin_some`, which runs what is ready when it begins: at most one message of
    each subscription.

    Attributes:
        due: the update that takes the next of them; beyond all updates while none waits.
        longest: for how many updates a command has waited beyond the first that could take it.
    """

    def __init__(self) -> None:
        self._waiting: deque[tuple[int, float, float]] = deque(maxlen=MOST_WAITING)
        self._free = 0  # the first update that has not taken one
        self.due = _NEVER
        self.longest = 0

    def add(self, update: int, v_mps: float, w_radps: float) -> None:
        """Add a command that no update before `update` can take. Earlier updates must have taken theirs."""
        if not self._waiting:
            self.due = max(update, self._free)
        self._waiting.append((update, v_mps, w_radps))  # whom it pushes out leaves `due` to the next

    def take(self) -> tuple[int, float, float]:
        """Return the update that takes the next command, and that; one must be waiting."""
        since, v, w = self._waiting.popleft()
        update = self.due
        self._free = free = update + 1
        self.longest = max(self.longest, update - since)
        self.due = max(self._waiting[0][0], free) if self._waiting else _NEVER
        return update, v, w

    def clear(self) -> None:
        """Lose them all."""
        self._waiting.clear()
        self.due = _NEVER

    @property
    def speeds(self) -> tuple[tuple[float, float], ...]:
        """(v, w) of those that wait, in order."""
        return tuple((v, w) for _, v, w in self._waiting)


class Turtle:
    """The graded turtle, or one that the script spawned.

    Each update takes one command from its `Inbox`. The first update more than 1.0 s after the one that took it
    drops it, as in turtlesim (`Turtle::update`): a single command moves the turtle in 63 updates.

    Attributes:
        alive: false between /kill and the next turtle of the same name; until then commands have no effect.
        commands: the velocity commands that it received.
    """

    def __init__(self, car: Car, recorder: Recorder, world: World, horizon_ns: int) -> None:
        self.start: PlanarPose = (world.start.x_m, world.start.y_m, math.radians(world.start.heading_deg))
        self.alive = True
        self.commands = ReceivedCommands(recorder)
        self._inbox = Inbox()
        self._deeds: deque[tuple[int, Callable[[Turtle], None]]] = deque(maxlen=MOST_DEEDS)
        self._car = car
        self._recorder = recorder
        self._horizon_ns = horizon_ns
        self._drop_ns = _NEVER
        self._world = world

    def appear(self) -> None:
        """Build the physical world, with the turtle at rest in the start pose. To be called first, once.

        Raises InfrastructureError: the simulator failed.
        """
        world = self._world
        self._car.reset(self._recorder, self.start, profile=world.profile, walls=world.walls, seed=world.seed)

    @property
    def resting(self) -> bool:
        """Whether the car stands still and would stay so without a new command."""
        return self._car.resting and self._inbox.due == _NEVER

    @property
    def velocity(self) -> tuple[float, float]:
        """(v, w) as the wheels turn: m/s along the heading and rad/s, whether or not a wall is in the way."""
        return self._car.velocity

    @property
    def pose(self) -> PlanarPose:
        """The pose at the last update advanced to."""
        return self._car.pose

    def advance(self, t_ns: int) -> None:
        """Run every update up to `t_ns`, but never past the horizon."""
        end_ns = min(t_ns, self._horizon_ns)
        inbox, last = self._inbox, end_ns // UPDATE_NS
        while inbox.due <= last:
            self._obey(*inbox.take())
        if self._drop_ns <= end_ns:
            self._drop()
        self._car.advance(end_ns)

    def receive(self, times_ns: Sequence[int], linear_x: float, linear_y: float, angular_z: float) -> None:
        """Let a velocity command of these times arrive, in order and not earlier than any instant advanced to.

        A sideways component is only counted: turtlesim 1.4 slides sideways, a car on two wheels cannot.
        """
        if not times_ns:
            return
        v, w, finite = clamp_command(linear_x, angular_z)
        updates = [t_ns // UPDATE_NS + 1 for t_ns in times_ns]  # `next_update`, inlined
        self.commands.take(times_ns, updates, (linear_x, linear_y, angular_z), (v, w, finite))
        if not self.alive:
            return
        inbox = self._inbox
        for update in updates:
            while inbox.due < update:
                self._obey(*inbox.take())
            inbox.add(update, v, w)
        if times_ns[-1] - self._car.now_ns >= _LAG_NS:
            self.advance(times_ns[-1])

    def take(self, t_ns: int) -> bool:
        """Have the update of `t_ns`, the next one, take its command; return whether one was waiting."""
        waits = t_ns <= self._horizon_ns and self._inbox.due <= t_ns // UPDATE_NS
        if waits:
            self._obey(*self._inbox.take())
        return waits

    def obey(self, t_ns: int, v_mps: float, w_radps: float) -> None:
        """Have the update after `t_ns` take a command that came then, if there is one and the turtle lives."""
        update = next_update(t_ns)
        if self.alive and update * UPDATE_NS <= self._horizon_ns:
            self._obey(update, *clamp_command(v_mps, w_radps)[:2])

    def _obey(self, update: int, v_mps: float, w_radps: float) -> None:
        """Set the velocity from `update` on, which takes it from the inbox."""
        car, begins_ns = self._car, update * UPDATE_NS
        if self._drop_ns < begins_ns:
            self._drop()
        if (v_mps, w_radps) != car.commanded:
            car.advance(begins_ns - UPDATE_NS)
            car.command(v_mps, w_radps)
        self._drop_ns = begins_ns + _LIFE_NS if v_mps or w_radps else _NEVER

    def _drop(self) -> None:
        self._car.advance(self._drop_ns)
        self._drop_ns = _NEVER
        self._car.command(0.0, 0.0)

    def drive(self, v_mps: float, w_radps: float) -> None:
        """Set the velocity from the next update on, as a rotation goal does."""
        self._done(lambda turtle: turtle.drive(v_mps, w_radps))
        self._car.command(v_mps, w_radps)
        update_ns = next_update(self._car.now_ns) * UPDATE_NS
        self._drop_ns = update_ns + _LIFE_NS if v_mps or w_radps else _NEVER

    def teleport(self, pose: PlanarPose) -> None:
        """Move to `pose` without driving there; the velocity is kept."""
        self._done(lambda turtle: turtle.teleport(pose))
        self._car.put(pose)

    def kill(self) -> None:
        """Stop at once; from now on commands have no effect."""
        self._done(Turtle.kill)
        self.forget()
        self._car.stop_dead()
        self._drop_ns = _NEVER
        self.alive = False

    def forget(self) -> None:
        """Lose the commands that wait."""
        self._inbox.clear()

    def revive(self, pose: PlanarPose) -> None:
        """Come back at `pose`, at rest: the script spawned a turtle under this one's name."""
        self.kill()
        self.teleport(pose)
        self._done(Turtle.live)
        self.live()

    def live(self) -> None:
        """Take commands again."""
        self.alive = True

    def _done(self, deed: "Callable[[Turtle], None]") -> None:
        """Remember what was done to the turtle beside commanding it, and when."""
        self._deeds.append((self._car.now_ns, deed))

    def at_once(self, recorded: Trajectory) -> Trajectory | None:
        """Return the motion if each command had been obeyed at once, None if none waited.

        It follows from the commands that were `recorded`, and from what else was done at its time.
        """
        nominal, remembered = self._world.profile == "nominal", len(self._deeds) < MOST_DEEDS
        if not (self._inbox.longest and nominal and remembered):
            return None
        end_ns = min(recorded.end_ns, self._horizon_ns)
        motion = obeyed_at_once(self._world, recorded.commands, end_ns, self._deeds)
        return replace(motion, commands=recorded.commands)

    @property
    def reckonable(self) -> bool:
        """Whether its poses follow from its commands alone: no noise that a script could foresee by knowing it."""
        return self.alive and self._world.profile == "nominal" and not self._car.lost

    def state(self, subscriptions: tuple[int, ...]) -> CarState:
        """Return what the poses that these subscriptions hear depend on, besides the ids of publishers."""
        car = self._car
        return CarState(
            subscriptions,
            (),
            car.now_ns,
            car.pose,
            car.velocity,
            car.commanded,
            self._inbox.speeds,
            self._drop_ns,
            car.resting,
            WINDOW_M if self._world.walls else 0.0,
        )

    def finish(self, end_ns: int) -> None:
        """Drive up to `end_ns`, when the episode ended, and record the last sample."""
        self.advance(end_ns)
        self._car.observe()
        self.commands.longest_wait = self._inbox.longest

    @property
    def steps_run(self) -> int:
        """Steps of 1/240 s simulated."""
        return self._car.steps_run


def obeyed_at_once(
    world: World,
    commands: Iterable[Command],
    end_ns: int,
    deeds: "Iterable[tuple[int, Callable[[Turtle], None]]]" = (),
) -> Trajectory:
    """Return the motion of a nominal turtle that obeys each command in the next update, up to `end_ns`.

    `commands`: in order, one before each update at most. `deeds`: what else is done to it in the update of a time.
    """
    recorder = Recorder()
    turtle = Turtle(Car(has_body=False), recorder, world, end_ns)
    turtle.appear()
    waiting = deque(deeds)
    for t_ns, v_mps, w_radps in (*commands, Command(_NEVER, 0.0, 0.0)):
        while waiting and waiting[0][0] <= t_ns:
            done_ns, deed = waiting.popleft()
            turtle.advance(done_ns)
            deed(turtle)
        turtle.obey(t_ns, v_mps, w_radps)
    turtle.finish(end_ns)
    return recorder.finish(end_ns)


def spawned(pose: PlanarPose, t_ns: int, *, walls: bool) -> Turtle:
    """Return a turtle that the script spawned at `t_ns`: nothing of it is recorded, and it is never scored."""
    turtle = Turtle(Car(has_body=False), Unrecorded(), World(walls=walls), _NEVER)
    turtle.start = pose
    turtle.appear()
    turtle.advance(t_ns)
    return turtle
