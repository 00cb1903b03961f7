"""A turtle, and turtlesim's rules for what is commanded to it."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import groupby
from operator import itemgetter
from typing import Final

from grader.contracts.assignment import WINDOW_M, World
from grader.contracts.trajectory import COMMAND_LIFE_NS, Trajectory
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
    each subscription. Of which only the `newest` waits, each update takes the last that came.

    Attributes:
        longest: for how many updates a command has waited beyond the first that could take it.
    """

    def __init__(self, *, newest: bool = False) -> None:
        self._waiting: deque[tuple[int, float, float]] = deque(maxlen=1 if newest else MOST_WAITING)
        self._free = 0  # the first update that has not taken one
        self.longest = 0

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def add(self, update: int, v_mps: float, w_radps: float) -> None:
        """Add a command that no update before `update` can take. Earlier updates must have taken theirs."""
        self._waiting.append((update, v_mps, w_radps))

    def take(self, last: int) -> tuple[int, float, float] | None:
        """Return the next command that an update up to `last` takes, and before it which one that is."""
        if not self._waiting:
            return None
        since, v, w = self._waiting[0]
        update = max(since, self._free)
        if update > last:
            return None
        self._waiting.popleft()
        self._free = update + 1
        self.longest = max(self.longest, update - since)
        return update, v, w

    def clear(self) -> None:
        """Lose them all."""
        self._waiting.clear()

    @property
    def speeds(self) -> tuple[tuple[float, float], ...]:
        """(v, w) of those that wait, in order."""
        return tuple((v, w) for _, v, w in self._waiting)


class Turtle:
    """The graded turtle, or one that the script spawned.

    Each update takes one command from its `Inbox`. The first update more than 1.0 s after the one that took it
    drops it, as in turtlesim (`Turtle::update`): a single command moves the turtle in 63 updates. One that obeys
    `at_once` takes the last command that came.

    Attributes:
        alive: false between /kill and the next turtle of the same name; until then commands have no effect.
        commands: the velocity commands that it received.
    """

    def __init__(
        self, car: Car, recorder: Recorder, world: World, horizon_ns: int, *, at_once: bool = False
    ) -> None:
        self.start: PlanarPose = (world.start.x_m, world.start.y_m, math.radians(world.start.heading_deg))
        self.alive = True
        self.commands = ReceivedCommands(recorder)
        self._inbox = Inbox(newest=at_once)
        self._deeds: deque[tuple[int, Callable[[Turtle], None]]] = deque(maxlen=MOST_DEEDS)
        self._car = car
        self._recorder = recorder
        self._horizon_ns = horizon_ns
        self._drop_ns = _NEVER
        self._world = world

    def appear(self) -> None:
        """Build the physical world, with the turtle at rest in the start pose. To be called first, once.

        Raises:
            InfrastructureError: the simulator failed.
        """
        world = self._world
        self._car.reset(self._recorder, self.start, profile=world.profile, walls=world.walls, seed=world.seed)

    @property
    def resting(self) -> bool:
        """Whether the car stands still and would stay so without a new command."""
        return self._car.resting and not self._inbox

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
        self._take_up_to(end_ns)
        if self._drop_ns <= end_ns:
            self._drop()
        self._car.advance(end_ns)

    def receive(self, times_ns: Sequence[int], linear_x: float, linear_y: float, angular_z: float) -> None:
        """Let a velocity command of these times arrive, in order and not earlier than any instant advanced to.

        A sideways component is only counted: turtlesim 1.4 slides sideways, a car on two wheels cannot.
        """
        v, w, finite = clamp_command(linear_x, angular_z)
        came = [(t_ns // UPDATE_NS + 1, t_ns) for t_ns in times_ns]  # `next_update`, inlined
        if not came:
            return
        self.commands.take(came, (linear_x, linear_y, angular_z), (v, w, finite))
        if not self.alive:
            return
        for update, t_ns in came:
            self._take_up_to(t_ns)
            self._inbox.add(update, v, w)
            if t_ns - self._car.now_ns >= _LAG_NS:
                self.advance(t_ns)

    def take(self, t_ns: int) -> bool:
        """Have the update of `t_ns`, the next one, take its command; return whether one was waiting."""
        taken = self._inbox.take(t_ns // UPDATE_NS) if t_ns <= self._horizon_ns else None
        if taken is not None:
            self._obey(*taken)
        return taken is not None

    def _take_up_to(self, t_ns: int) -> None:
        last = t_ns // UPDATE_NS
        while (taken := self._inbox.take(last)) is not None:
            self._obey(*taken)

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
        recorder = Recorder()
        turtle = Turtle(Car(has_body=False), recorder, self._world, self._horizon_ns, at_once=True)
        turtle.appear()
        deeds = deque(self._deeds)
        for (v, w), same in groupby(recorded.commands, key=itemgetter(1, 2)):
            times_ns = [command.t_ns for command in same]
            while deeds and deeds[0][0] < times_ns[-1]:
                done_ns, deed = deeds.popleft()
                turtle.receive([t_ns for t_ns in times_ns if t_ns <= done_ns], v, 0.0, w)
                times_ns = [t_ns for t_ns in times_ns if t_ns > done_ns]
                turtle.advance(done_ns)
                deed(turtle)
            turtle.receive(times_ns, v, 0.0, w)
        for done_ns, deed in deeds:
            turtle.advance(done_ns)
            deed(turtle)
        turtle.finish(recorded.end_ns)
        return replace(recorder.finish(recorded.end_ns), commands=())

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


def spawned(pose: PlanarPose, t_ns: int, *, walls: bool) -> Turtle:
    """Return a turtle that the script spawned at `t_ns`: nothing of it is recorded, and it is never scored."""
    turtle = Turtle(Car(has_body=False), Unrecorded(), World(walls=walls), _NEVER)
    turtle.start = pose
    turtle.appear()
    turtle.advance(t_ns)
    return turtle
