"""turtle1: turtlesim's rules for a velocity command, obeyed by the car."""

import math
from typing import Final

from grader.contracts.assignment import World
from grader.contracts.trajectory import COMMAND_LIFE_NS, Command
from grader.sim.bullet import BulletCar
from grader.sim.car import PlanarPose, clamp_command
from grader.sim.recorder import Recorder
from grader.sim.timeline import first_step_at, last_step_at

_NEVER: Final = 1 << 62
_LAG_STEPS: Final = 24
"""How far the car may stay behind commands that only repeat its present one: less often is done in one go, and
0.1 s is little enough for driving and the script's own computing to go on side by side."""


class Turtle:
    """The graded turtle.

    A command of time t acts from the first physics step at or after t on; the last one before a step wins.
    It is dropped at the first step later than t + 1.0 s, as turtlesim does (`Turtle::update`).

    Attributes:
        alive: false between /kill and the next turtle of the same name; a dead turtle obeys nothing.
        command_count, nonfinite_commands, lateral_commands, clamped_commands: commands received, and how many
            of them had a NaN or infinite component, a sideways one, or one beyond the car's bounds.
        first_command_ns, last_command_ns: when they came.
    """

    def __init__(self, car: BulletCar, recorder: Recorder, world: World, horizon_ns: int) -> None:
        self.start: PlanarPose = (world.start.x_m, world.start.y_m, math.radians(world.start.heading_deg))
        self.alive = True
        self.command_count = self.nonfinite_commands = self.lateral_commands = self.clamped_commands = 0
        self.first_command_ns: int | None = None
        self.last_command_ns: int | None = None
        self._car = car
        self._recorder = recorder
        self._last_step = last_step_at(horizon_ns)
        self._drop_step = _NEVER
        self._world = world

    def appear(self) -> None:
        """Build the physical world and stand at rest in the start pose. Nothing else may come before.

        Raises:
            InfrastructureError: the simulator failed.
        """
        world = self._world
        self._car.reset(self._recorder, self.start, profile=world.profile, walls=world.walls, seed=world.seed)

    @property
    def resting(self) -> bool:
        """Whether the car stands still and would stay so without a new command."""
        return self._car.servo.resting

    @property
    def velocity(self) -> tuple[float, float]:
        """(v, w) as the wheels turn: m/s along the heading and rad/s, whether or not a wall is in the way."""
        return self._car.servo.v_mps, self._car.servo.w_radps

    def pose_at(self, t_ns: int) -> PlanarPose:
        """Return the pose at `t_ns`, up to which the turtle has been advanced."""
        return self._car.pose_at(t_ns)

    def advance(self, t_ns: int) -> None:
        """Drive until the first step at or after `t_ns`, but never past the horizon."""
        self._advance(first_step_at(t_ns))

    def _advance(self, step: int) -> None:
        end = min(step, self._last_step)
        if self._drop_step <= end:
            self._car.advance(self._drop_step)
            self._drop_step = _NEVER
            self._car.command(0.0, 0.0)
        self._car.advance(end)

    def receive(self, t_ns: int, linear_x: float, linear_y: float, angular_z: float) -> None:
        """Take a velocity command of time `t_ns`, not earlier than any instant advanced to.

        A sideways component is only counted: turtlesim 1.4 slides sideways, a car on two wheels cannot.
        """
        step = first_step_at(t_ns)
        v, w, finite = clamp_command(linear_x, angular_z)
        if (v, w) != self._car.commanded or step >= self._drop_step or step - self._car.step >= _LAG_STEPS:
            self._advance(step)
        if not finite:
            self.nonfinite_commands += 1
        elif v != linear_x or w != angular_z:
            self.clamped_commands += 1
        if linear_y:
            self.lateral_commands += 1
        self.command_count += 1
        if self.first_command_ns is None:
            self.first_command_ns = t_ns
        self.last_command_ns = t_ns
        self._recorder.command(step, Command(t_ns, v, w))
        if self.alive:
            self.drive(t_ns, v, w)

    def drive(self, t_ns: int, v_mps: float, w_radps: float) -> None:
        """Set the velocity as from `t_ns`: a command's, or that of a rotation goal."""
        self._car.command(v_mps, w_radps)
        self._drop_step = first_step_at(t_ns + COMMAND_LIFE_NS + 1) if v_mps or w_radps else _NEVER

    def teleport(self, pose: PlanarPose) -> None:
        """Be put into `pose` without driving there; the velocity is kept."""
        self._car.put(pose)

    def kill(self) -> None:
        """Stand still at once and obey nothing."""
        self._car.stop_dead()
        self._drop_step = _NEVER
        self.alive = False

    def revive(self, pose: PlanarPose) -> None:
        """Appear in `pose`, at rest."""
        self.kill()
        self._car.put(pose)
        self.alive = True

    def finish(self, end_ns: int) -> None:
        """Take the last sample; `end_ns` is when the episode ended."""
        self.advance(end_ns)
        self._car.observe()

    @property
    def steps_run(self) -> int:
        """Physics steps computed."""
        return self._car.steps_run
