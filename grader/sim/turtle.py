"""turtlesim's rules for a velocity command: the graded turtle, which is the car, and those a script spawns."""

import math
from collections.abc import Sequence
from typing import Final, Protocol

from grader.contracts.assignment import WINDOW_M, World
from grader.contracts.trajectory import COMMAND_LIFE_NS
from grader.sim.car import UPDATE_NS, PlanarPose, clamp_command, next_update, turtlesim_update
from grader.sim.driving import Car
from grader.sim.frames import CarState
from grader.sim.recorder import ReceivedCommands, Recorder

_NEVER: Final = 1 << 62
_LIFE_UPDATES: Final = COMMAND_LIFE_NS // UPDATE_NS
_LIFE_NS: Final = (_LIFE_UPDATES + 1) * UPDATE_NS - 1
"""From the update that takes a command until it is dropped. An instant on an update itself would be too late: a
command is taken by the update after it."""
_LAG_NS: Final = 100_000_000
"""How far the car may lag behind while commands only repeat the present one. Driving in larger pieces costs less;
0.1 s is small enough for the car to drive while the script computes, instead of after it."""


class AnyTurtle(Protocol):
    """A turtle as turtlesim's topics, services and action use it: the graded one or a spawned one."""

    start: PlanarPose
    alive: bool

    @property
    def pose(self) -> PlanarPose:
        """Where it stands."""

    @property
    def velocity(self) -> tuple[float, float]:
        """(v, w) as commanded."""

    def drive(self, v_mps: float, w_radps: float) -> None:
        """Set the velocity from the next update on."""

    def teleport(self, pose: PlanarPose) -> None:
        """Move to `pose` at once; the velocity is kept."""


class Turtle:
    """The graded turtle.

    An update takes the last command that came before it. The first update more than 1.0 s later drops that
    command, as in turtlesim (`Turtle::update`): a single command moves the turtle in 63 updates.

    Attributes:
        alive: false between /kill and the next turtle of the same name; until then commands have no effect.
        commands: the velocity commands that it received.
    """

    def __init__(self, car: Car, recorder: Recorder, world: World, horizon_ns: int) -> None:
        self.start: PlanarPose = (world.start.x_m, world.start.y_m, math.radians(world.start.heading_deg))
        self.alive = True
        self.commands = ReceivedCommands(recorder)
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
        return self._car.resting

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
        if self._drop_ns <= end_ns:
            self._car.advance(self._drop_ns)
            self._drop_ns = _NEVER
            self._car.command(0.0, 0.0)
        self._car.advance(end_ns)

    def receive(self, times_ns: Sequence[int], linear_x: float, linear_y: float, angular_z: float) -> None:
        """Take a velocity command of these times, in order and not earlier than any instant advanced to.

        A sideways component is only counted: turtlesim 1.4 slides sideways, a car on two wheels cannot.
        """
        v, w, finite = clamp_command(linear_x, angular_z)
        came = [(t_ns // UPDATE_NS + 1, t_ns) for t_ns in times_ns]  # `next_update`, inlined
        self.commands.take(came, (linear_x, linear_y, angular_z), (v, w, finite))
        car, order, moves = self._car, (v, w), bool(v or w)
        for update, t_ns in came:
            if order != car.commanded or t_ns >= self._drop_ns or t_ns - car.now_ns >= _LAG_NS:
                self.advance(t_ns)
            if self.alive:
                if order != car.commanded:
                    car.command(v, w)
                self._drop_ns = update * UPDATE_NS + _LIFE_NS if moves else _NEVER

    def drive(self, v_mps: float, w_radps: float) -> None:
        """Set the velocity from the next update on, as a rotation goal does."""
        self._car.command(v_mps, w_radps)
        update_ns = next_update(self._car.now_ns) * UPDATE_NS
        self._drop_ns = update_ns + _LIFE_NS if v_mps or w_radps else _NEVER

    def teleport(self, pose: PlanarPose) -> None:
        """Move to `pose` without driving there; the velocity is kept."""
        self._car.put(pose)

    def kill(self) -> None:
        """Stop at once; from now on commands have no effect."""
        self._car.stop_dead()
        self._drop_ns = _NEVER
        self.alive = False

    def revive(self, pose: PlanarPose) -> None:
        """Come back at `pose`, at rest: the script spawned a turtle under this one's name."""
        self.kill()
        self._car.put(pose)
        self.alive = True

    @property
    def reckonable(self) -> bool:
        """Whether its poses follow from its commands alone: no noise that a script could foresee by knowing it."""
        return self.alive and self._world.profile == "nominal"

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
            self._drop_ns,
            car.resting,
            WINDOW_M if self._world.walls else 0.0,
        )

    def finish(self, end_ns: int) -> None:
        """Drive up to `end_ns`, when the episode ended, and record the last sample."""
        self.advance(end_ns)
        self._car.observe()

    @property
    def steps_run(self) -> int:
        """Steps of 1/240 s simulated."""
        return self._car.steps_run


class SpawnedTurtle:
    """A turtle that the script spawned: it moves by turtlesim's law, without physics, and is never scored.

    Attributes:
        start: where it was spawned.
        pose, velocity: the pose after the last update advanced to, and (v, w) in that update.
        alive: false once it is killed.
    """

    def __init__(self, pose: PlanarPose, t_ns: int, *, walls: bool) -> None:
        self.velocity = (0.0, 0.0)
        self.alive = True
        self._walls = walls
        self._put(pose)
        self.start = self.pose
        self._updates = t_ns // UPDATE_NS
        self._commanded = (0.0, 0.0)
        self._drop = _NEVER

    def advance(self, t_ns: int) -> None:
        """Run every update up to `t_ns`."""
        last = t_ns // UPDATE_NS
        while self._updates < last and (self._commanded != (0.0, 0.0) or self.velocity != (0.0, 0.0)):
            self._updates += 1
            if self._updates >= self._drop:
                self._commanded = (0.0, 0.0)
            self.velocity = self._commanded
            self._put(turtlesim_update(self.pose, *self.velocity))
        self._updates = max(self._updates, last)

    def receive(self, t_ns: int, linear_x: float, angular_z: float) -> None:
        """Take a velocity command of time `t_ns`, not earlier than any instant advanced to."""
        self.advance(t_ns)
        v, w, _ = clamp_command(linear_x, angular_z)
        self.drive(v, w)

    def drive(self, v_mps: float, w_radps: float) -> None:
        """Set the velocity from the next update on."""
        self._commanded = (v_mps, w_radps)
        self._drop = self._updates + 1 + _LIFE_UPDATES + 1

    def teleport(self, pose: PlanarPose) -> None:
        """Move to `pose` at once; the velocity is kept."""
        self._put(pose)

    def _put(self, pose: PlanarPose) -> None:
        x, y, heading = pose
        if self._walls:
            x, y = min(max(x, 0.0), WINDOW_M), min(max(y, 0.0), WINDOW_M)
        self.pose = (x, y, heading)
