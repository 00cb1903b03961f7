"""The physical car: the only module that knows PyBullet."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from math import atan2, cos, hypot, isfinite, sin
from typing import Final, Protocol

from grader.contracts.assignment import WINDOW_M, Profile
from grader.contracts.errors import InfrastructureError
from grader.sim.car import (
    RIDE_HEIGHT_M,
    STEP_S,
    UPDATE_NS,
    UPDATE_S,
    URDF,
    WHEEL_RADIUS_M,
    PlanarPose,
    RoughDrive,
    fold,
    last_step_at,
    step_time_ns,
    turtlesim_update,
    twist_to_wheels,
)


@contextmanager
def _silenced() -> Iterator[None]:
    """Turn standard output and error to nowhere meanwhile, below Python: for code that prints from C."""
    sys.stdout.flush()
    saved = [(stream, os.dup(stream)) for stream in (1, 2)]
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream, _ in saved:
            os.dup2(null, stream)
        yield
    finally:
        for stream, copy in saved:
            os.dup2(copy, stream)
            os.close(copy)
        os.close(null)


with _silenced():  # the import prints when PyBullet was built
    import pybullet as _bullet

# What is called at every update or step, with the client as last positional argument: keywords cost a tenth.
_get_pose: Final = _bullet.getBasePositionAndOrientation
_set_velocity: Final = _bullet.resetBaseVelocity
_set_time_step: Final = _bullet.setTimeStep
_step_once: Final = _bullet.stepSimulation
_get_velocity: Final = _bullet.getBaseVelocity

CAR_MODEL: Final = 2  # raised whenever the same commands may give another trajectory
SIMULATOR: Final = f"turtle-car {CAR_MODEL}, Bullet {_bullet.getAPIVersion()}"

_GRAVITY_MPS2: Final = -9.81
_SOLVER_ITERATIONS: Final = 4  # the wheels' and casters' contacts are four points: they converge in three
_WHEEL_JOINTS: Final = (0, 1)
_MOTORS_NM: Final = (0.1, 0.1)
_MAX_JOINT_RADPS: Final = 4_000.0  # PyBullet's own bound of 100 would hold the wheels back at 5 m/s
_HALF_S: Final = STEP_S / 2.0
_TOUCH_M: Final = 1e-6  # a wall pushed by less is not being pushed: the car slides along it
_WIDE_TURN_RAD: Final = 0.5  # Bullet loses a body that turns by more than a quarter turn in one engine step
_BEHIND_UPDATES: Final = 8  # taken along at each update, the body costs a grading a quarter of its time
_QUICK_RADPS: Final = _WIDE_TURN_RAD / (_BEHIND_UPDATES * UPDATE_S)
_QUICK_MPS: Final = 5.0  # wheels that are faster tilt the body, the more the longer an engine step is
# In m and rad. The body stays within 1e-8; at 100 rad/s its wheels, as gyroscopes, tilt it by 5e-3.
_ASTRAY: Final = 0.05


class Watcher(Protocol):
    """Receives what the car does, while it does it."""

    def sample(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Take the state at the update of `t_ns`, and the velocity with which the update reached it."""

    def jump(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Take the state into which the car was put after the update of `t_ns`."""

    def contact(self, start_ns: int, end_ns: int, wall: str) -> None:
        """Learn that `wall` held the car back from `start_ns` to `end_ns`."""


class Client:
    """A world of PyBullet's."""

    def __init__(self, purpose: str = "a physics client") -> None:
        self._client: int = _bullet.connect(_bullet.DIRECT)
        if self._client < 0:
            raise InfrastructureError(f"PyBullet refused {purpose}")

    def close(self) -> None:
        """Give the client back. Nothing else is usable afterwards."""
        if self._client >= 0:
            _bullet.disconnect(physicsClientId=self._client)
            self._client = -1


class BulletCar(Client):
    """A car in a PyBullet world of its own, driven in turtlesim's updates of 16 ms.

    One object serves any number of episodes, one after the other: `reset` builds the world anew, so nothing
    of an earlier episode is left and the same commands give the same bits. The physics client stays.

    The nominal car moves by turtlesim's law to the last bit. Its body is given the velocity that takes it along
    at each eighth update, at each one of a quick car, and when it comes to rest, and must be found where the law
    says. The rough car is where physics takes its body. Tyres and casters are frictionless, so that they carry the
    car and never steer it, and the wheels' motors turn along. Walls are turtlesim's: the position is held within
    the window, component by component, and the heading is not affected.

    Attributes:
        now_ns: instant of the update the state stands at.
        pose: the car's at that instant.
        velocity: (v, w) at which the wheels turned in that update, whether or not a wall was in the way.
        resting: stopped, told to stay so, and seen at rest: updates would change nothing.
        body_pose: where PyBullet has the body, at the last whole step before that instant; that of the nominal car
            may be seven updates behind while it drives.
        steps_run: steps of 1/240 s simulated since `reset`; those of a resting car are not.
        commanded: the twist that acts from the next update on.
    """

    def __init__(self) -> None:
        """Connect to PyBullet and build the world of the first episode: it takes 10 ms, later ones take 2 ms.

        Raises:
            InfrastructureError: PyBullet failed.
        """
        super().__init__()
        with faults():
            self._body = _build(self._client)
        self._is_new = True  # nothing has happened in the world that stands there
        self._walls = False
        self._rough: RoughDrive | None = None
        self.body_pose: PlanarPose = (0.0, 0.0, 0.0)
        self._measured = (0.0, 0.0)
        self.pose = self.body_pose
        self.velocity = self.commanded = (0.0, 0.0)
        self.now_ns = self.steps_run = self._body_step = 0
        self.resting = True

    def reset(self, watcher: Watcher, start: PlanarPose, *, profile: Profile, walls: bool, seed: int) -> None:
        """Start an episode at time 0 with the car at rest in pose `start`.

        Raises:
            InfrastructureError: PyBullet failed.
        """
        self._watcher = watcher
        self._walls = walls
        self._rough = RoughDrive(seed) if profile == "rough" else None
        self.velocity = self.commanded = self._measured = self._turned = (0.0, 0.0)
        self.now_ns = self.steps_run = 0
        self.resting = True
        with faults():
            if not self._is_new:
                _bullet.resetSimulation(physicsClientId=self._client)
                self._body = _build(self._client)
            self._is_new = False
            self._place(start)
        self.observe()

    def command(self, v_mps: float, w_radps: float) -> None:
        """Command (v, w) from the next update on; it must be within the bounds of `clamp_command`."""
        if (v_mps, w_radps) == self.commanded:
            return
        if self.resting:
            self.observe()  # the end of the rest: before it, the car stood still
            self.resting = False
            self._body_step = last_step_at(self.now_ns)
        self.commanded = (v_mps, w_radps)
        if self._rough is not None:
            self._rough.aim(v_mps, w_radps)
            with faults():
                self._turn_wheels(v_mps, w_radps)

    def advance(self, t_ns: int) -> None:
        """Run every update up to `t_ns` under the present command. A resting car gets there without them.

        Raises:
            InfrastructureError: PyBullet failed, or the car is not where it should be.
        """
        if not self.resting and self.now_ns + UPDATE_NS <= t_ns:
            first = last_step_at(self.now_ns)
            try:  # not `faults`: a script that steers by the pose comes here at each
                if self._rough is None:
                    self._follow_the_law(t_ns)
                else:
                    self._drive(self._rough, t_ns)
            except _bullet.error as error:
                raise _fault(error) from error
            self.steps_run += last_step_at(self.now_ns) - first
        self.now_ns = max(self.now_ns, t_ns - t_ns % UPDATE_NS)

    def put(self, pose: PlanarPose) -> None:
        """Take the car up and put it down in `pose`, after the present update; its velocity is kept."""
        self.observe()
        with faults():
            self._place(pose)
        self._watcher.jump(self.now_ns, self.pose, *self._measured)

    def stop_dead(self) -> None:
        """Take all velocity away at once, as for a robot that is removed or made anew."""
        self.command(0.0, 0.0)
        if self._rough is not None:
            self._rough.halt()
        self._measured = (0.0, 0.0)

    def observe(self) -> None:
        """Hand the watcher the state at the present update."""
        self._watcher.sample(self.now_ns, self.pose, *self._measured)

    def run_bare(self, steps: int, v_mps: float, w_radps: float) -> None:
        """Drive `steps` steps of 1/240 s with only the three calls a step needs: the floor of benchmarks."""
        body, client = self._body, self._client
        linear, angular = (v_mps, 0.0, 0.0), (0.0, 0.0, w_radps)
        for _ in range(steps):
            _get_pose(body, client)
            _set_velocity(body, linear, angular, client)
            _step_once(client)

    def _follow_the_law(self, t_ns: int) -> None:
        """Move by turtlesim's law up to `t_ns`, or to rest; let the body follow now and then."""
        v, w = self.velocity = self.commanded
        self.resting = v == w == 0.0
        each_time = self.resting or abs(v) > _QUICK_MPS or abs(w) > _QUICK_RADPS
        last_ns = self.now_ns + UPDATE_NS if self.resting else t_ns
        while self.now_ns + UPDATE_NS <= last_ns:
            before = self.pose
            self.now_ns += UPDATE_NS
            x, y, heading = turtlesim_update(before, v, w)
            if self._walls and not (0.0 <= x <= WINDOW_M and 0.0 <= y <= WINDOW_M):
                start_ns = self.now_ns - UPDATE_NS
                x = self._held(start_ns, self.now_ns, x, "left", "right")
                y = self._held(start_ns, self.now_ns, y, "bottom", "top")
                along = (x - before[0]) * cos(heading) + (y - before[1]) * sin(heading)
                self._measured = (along / UPDATE_S, w)
            else:
                self._measured = (v, w)
            self.pose = (x, y, heading)
            if each_time or self.now_ns % (_BEHIND_UPDATES * UPDATE_NS) == 0:
                self._take_along(before)
            self._watch()

    def _watch(self) -> None:
        """Have the update watched that was just run."""
        (x, y, heading), (v, w) = self.pose, self._measured
        if not isfinite(x + y + heading + v + w):
            raise InfrastructureError("the simulated car left the realm of numbers")
        self._watcher.sample(self.now_ns, self.pose, v, w)

    def _take_along(self, before: PlanarPose) -> None:
        """Bring the body to where the law has the car at the last step, on the line from `before`, one update ago.

        Its velocity is constant meanwhile and no force acts along the floor, so that one engine step over all of
        the time does what its single steps would do.
        """
        last = last_step_at(self.now_ns)
        steps, until_ns = last - self._body_step, step_time_ns(last)
        self._body_step = last
        body, client = self._body, self._client
        self._turn_wheels(*self.commanded)
        share = 1.0 - (self.now_ns - until_ns) / UPDATE_NS
        x = before[0] + (self.pose[0] - before[0]) * share
        y = before[1] + (self.pose[1] - before[1]) * share
        heading = before[2] + fold(self.pose[2] - before[2]) * share
        at_x, at_y, at_heading = self.body_pose
        turn, seconds = fold(heading - at_heading), steps * STEP_S
        linear = ((x - at_x) / seconds, (y - at_y) / seconds, 0.0)
        engine_steps = 1 if abs(turn) < _WIDE_TURN_RAD else steps
        _set_time_step(seconds / engine_steps, client)
        for _ in range(engine_steps):
            _set_velocity(body, linear, (0.0, 0.0, turn / seconds), client)
            _step_once(client)
        (at_x, at_y, _), (_, _, qz, qw) = _get_pose(body, client)
        self.body_pose = (at_x, at_y, 2.0 * atan2(qz, qw))
        if hypot(at_x - x, at_y - y) > _ASTRAY or abs(fold(self.body_pose[2] - heading)) > _ASTRAY:
            raise InfrastructureError("the simulated car's body is not where its law says")

    def _turn_wheels(self, v_mps: float, w_radps: float) -> None:
        """Have the motors turn the wheels at the speeds that this velocity needs."""
        if (v_mps, w_radps) == self._turned:
            return
        self._turned = (v_mps, w_radps)
        _bullet.setJointMotorControlArray(
            self._body,
            _WHEEL_JOINTS,
            _bullet.VELOCITY_CONTROL,
            targetVelocities=twist_to_wheels(v_mps, w_radps),
            forces=_MOTORS_NM,
            physicsClientId=self._client,
        )

    def _drive(self, rough: RoughDrive, t_ns: int) -> None:
        """Run the updates up to `t_ns`, or to rest, under the rough drive."""
        while not self.resting and self.now_ns + UPDATE_NS <= t_ns:
            first = last_step_at(self.now_ns)
            self.now_ns += UPDATE_NS
            self._step(rough, first, last_step_at(self.now_ns))
            self._watch()

    def _step(self, rough: RoughDrive, first: int, last: int) -> None:
        """Step the body under the rough drive from step `first` to step `last`."""
        body, client = self._body, self._client
        x, y, heading = self.pose
        for step in range(first, last):
            v, w = rough.step()
            # Half of the step's turn ahead, along the chord of the arc: circles close to second order.
            vx, vy = v * cos(heading + _HALF_S * w), v * sin(heading + _HALF_S * w)
            if self._walls and not (
                0.0 <= x + vx * STEP_S <= WINDOW_M and 0.0 <= y + vy * STEP_S <= WINDOW_M
            ):
                start_ns, end_ns = step_time_ns(step), step_time_ns(step + 1)
                vx = (self._held(start_ns, end_ns, x + vx * STEP_S, "left", "right") - x) / STEP_S
                vy = (self._held(start_ns, end_ns, y + vy * STEP_S, "bottom", "top") - y) / STEP_S
            _set_velocity(body, (vx, vy, 0.0), (0.0, 0.0, w), client)
            _step_once(client)
            (x, y, _), (_, _, qz, qw) = _get_pose(body, client)
            heading = 2.0 * atan2(qz, qw)
        if self._walls:
            x, y = _within(x), _within(y)
        self.pose = (x, y, heading)
        self.velocity = (rough.v_mps, rough.w_radps)
        self.resting = rough.resting
        (vx, vy, _), (_, _, w) = _get_velocity(body, client)
        self._measured = (0.0, 0.0) if rough.resting else (vx * cos(heading) + vy * sin(heading), w)

    def _held(self, start_ns: int, end_ns: int, aim_m: float, low: str, high: str) -> float:
        """Return one component of the position as the window bounds it; note the wall that is pushed."""
        bound = _within(aim_m)
        if abs(aim_m - bound) > _TOUCH_M:
            self._watcher.contact(start_ns, end_ns, low if aim_m < bound else high)
        return bound

    def _place(self, pose: PlanarPose) -> None:
        x, y, heading = pose
        if self._walls:
            x, y = _within(x), _within(y)
        self.pose = self.body_pose = (x, y, heading)
        self._body_step = last_step_at(self.now_ns)
        orientation = (0.0, 0.0, sin(heading / 2.0), cos(heading / 2.0))
        _bullet.resetBasePositionAndOrientation(
            self._body, (x, y, RIDE_HEIGHT_M), orientation, physicsClientId=self._client
        )


class _Faults:
    """Turns PyBullet's own exception into the grader's. No generator, which costs more: each command has one."""

    def __enter__(self) -> None:
        pass

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        if isinstance(error, _bullet.error):
            raise _fault(error) from error


_FAULTS = _Faults()


def faults() -> _Faults:
    """Turn PyBullet's own exception into the grader's."""
    return _FAULTS


def _fault(error: BaseException) -> InfrastructureError:
    return InfrastructureError(f"PyBullet: {error}")


def _within(position_m: float) -> float:
    return min(max(position_m, 0.0), WINDOW_M)


def _build(client: int) -> int:
    """Lay the floor in an empty world and load the car; return its body."""
    _bullet.setRealTimeSimulation(0, physicsClientId=client)
    _bullet.setPhysicsEngineParameter(
        fixedTimeStep=STEP_S,
        numSubSteps=0,
        numSolverIterations=_SOLVER_ITERATIONS,
        deterministicOverlappingPairs=1,
        physicsClientId=client,
    )
    _bullet.setGravity(0.0, 0.0, _GRAVITY_MPS2, physicsClientId=client)
    floor = _bullet.createCollisionShape(_bullet.GEOM_PLANE, physicsClientId=client)
    _bullet.createMultiBody(0.0, floor, physicsClientId=client)
    body: int = _bullet.loadURDF(
        str(URDF),
        (0.0, 0.0, WHEEL_RADIUS_M),
        flags=_bullet.URDF_USE_INERTIA_FROM_FILE,
        physicsClientId=client,
    )
    # Friction is the URDF's: changeDynamics silently skips a link's friction when told a damping as well.
    _bullet.changeDynamics(
        body,
        -1,
        linearDamping=0.0,
        angularDamping=0.0,
        maxJointVelocity=_MAX_JOINT_RADPS,
        physicsClientId=client,
    )
    return body
