"""The physical car: the only module that knows PyBullet."""

from collections.abc import Iterator
from contextlib import contextmanager
from math import atan2, cos, isfinite, sin
from typing import Final, Protocol

from grader.contracts.assignment import WINDOW_M, Profile
from grader.contracts.errors import InfrastructureError
from grader.sim.car import (
    RIDE_HEIGHT_M,
    URDF,
    WHEEL_RADIUS_M,
    PlanarPose,
    Servo,
    make_servo,
    twist_to_wheels,
)
from grader.sim.silence import silenced
from grader.sim.timeline import NS_PER_S, SAMPLE_STEPS, STEP_S, step_time_ns

with silenced():  # it says when it was built
    import pybullet as _bullet

# What is called at every step or sample, with the client as last positional argument: keywords cost a tenth.
_get_pose: Final = _bullet.getBasePositionAndOrientation
_set_velocity: Final = _bullet.resetBaseVelocity
_step_once: Final = _bullet.stepSimulation
_get_velocity: Final = _bullet.getBaseVelocity

CAR_MODEL: Final = 1  # raised whenever the same commands may give another trajectory
SIMULATOR: Final = f"turtle-car {CAR_MODEL}, Bullet {_bullet.getAPIVersion()}"

_GRAVITY_MPS2: Final = -9.81
_SOLVER_ITERATIONS: Final = 4  # the wheels' and casters' contacts are four points: they converge in three
_WHEEL_JOINTS: Final = (0, 1)
_MOTORS_NM: Final = (0.1, 0.1)
_MAX_JOINT_RADPS: Final = 4_000.0  # PyBullet's own bound of 100 would hold the wheels back at 5 m/s
_HALF_S: Final = STEP_S / 2.0
_CLEARANCE_M: Final = 1e-3  # more than rounding and contacts ever move the car besides its velocity
_TOUCH_M: Final = 1e-6  # a wall pushed by less per step is not being pushed: the car slides along it


class Watcher(Protocol):
    """Receives what the car does, while it does it."""

    def sample(self, step: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Take the measured state at `step`."""

    def jump(self, step: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Take the state into which the car was put at `step`."""

    def contact(self, step: int, wall: str) -> None:
        """Learn that `wall` held the car back during the step that ends at `step`."""


class BulletCar:
    """A car in a PyBullet world of its own.

    One object serves any number of episodes, one after the other: `reset` builds the world anew, so nothing
    of an earlier episode is left and the same commands give the same bits. The physics client stays.

    The base obeys the servo of `grader.sim.car`; tyres and casters are frictionless, so that they carry the
    car and never steer it, and the wheels' motors turn along. Walls are turtlesim's: the position is held
    within the window, component by component, and the heading is not affected.

    Attributes:
        step: index of the step the state stands at.
        steps_run: physics steps actually computed since `reset`; a resting car is not stepped.
        servo: the drive; its velocity is what wheel encoders would read. commanded: the present command.
    """

    servo: Servo

    def __init__(self) -> None:
        self._client: int = _bullet.connect(_bullet.DIRECT)
        if self._client < 0:
            raise InfrastructureError("PyBullet refused a physics client")
        self._body = -1
        self.step = self.steps_run = 0
        self._x = self._y = self._vx = self._vy = 0.0
        self._qz, self._qw, self._walls = 0.0, 1.0, False
        self.commanded = (0.0, 0.0)

    def close(self) -> None:
        """Give the physics client back. The car is not usable afterwards."""
        if self._client >= 0:
            _bullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def reset(self, watcher: Watcher, start: PlanarPose, *, profile: Profile, walls: bool, seed: int) -> None:
        """Start an episode at step 0 with the car at rest in pose `start`.

        Raises:
            InfrastructureError: PyBullet failed.
        """
        with _faults():
            if self._body >= 0:  # a new client's world is empty: spare a cold start the 5 ms
                _bullet.resetSimulation(physicsClientId=self._client)
            self._body = _build(self._client)
        self._watcher = watcher
        self._walls = walls
        self.servo = make_servo(profile, seed)
        self.commanded = (0.0, 0.0)
        self.step = self.steps_run = 0
        self._place(start)
        watcher.sample(0, (self._x, self._y, start[2]), 0.0, 0.0)

    def command(self, v_mps: float, w_radps: float) -> None:
        """Let (v, w) act from the present step on; it must be within the bounds of `clamp_command`."""
        if (v_mps, w_radps) == self.commanded:
            return
        if self.servo.resting:
            self.observe()  # the end of the rest: before it, the car stood still
        self.commanded = (v_mps, w_radps)
        self.servo.aim(v_mps, w_radps)
        with _faults():
            _bullet.setJointMotorControlArray(
                self._body,
                _WHEEL_JOINTS,
                _bullet.VELOCITY_CONTROL,
                targetVelocities=twist_to_wheels(v_mps, w_radps),
                forces=_MOTORS_NM,
                physicsClientId=self._client,
            )

    def advance(self, end: int) -> None:
        """Run up to step `end` under the present command. A resting car gets there without being stepped.

        Raises:
            InfrastructureError: PyBullet failed, or the state is no longer finite.
        """
        if not self.servo.resting and self.step < end:
            try:
                self._run(end)
            except _bullet.error as error:
                raise InfrastructureError(f"PyBullet: {error}") from error
        self.step = max(self.step, end)

    def pose_at(self, t_ns: int) -> PlanarPose:
        """Return the pose at `t_ns`, at most a step before the state's, on the line between them."""
        back_s = min(max((step_time_ns(self.step) - t_ns) / NS_PER_S, 0.0), STEP_S)
        if self.servo.resting:
            back_s = 0.0
        x, y = self._x - self._vx * back_s, self._y - self._vy * back_s
        if self._walls:
            x, y = _within(x), _within(y)
        return x, y, 2.0 * atan2(self._qz, self._qw) - self.servo.w_radps * back_s

    def put(self, pose: PlanarPose) -> None:
        """Take the car up and put it down in `pose`, at the present step; its velocity is kept."""
        self.observe()
        with _faults():
            self._place(pose)
        state = (self._x, self._y, pose[2])
        self._watcher.jump(self.step, state, self.servo.v_mps, self.servo.w_radps)

    def stop_dead(self) -> None:
        """Take all velocity away at once, as for a robot that is removed or made anew."""
        self.observe()
        self.servo.halt()
        self.commanded = (0.0, 0.0)
        self._vx = self._vy = 0.0

    def run_bare(self, steps: int, v_mps: float, w_radps: float) -> None:
        """Drive `steps` steps with only the three calls a step needs: the floor of benchmarks."""
        body, client = self._body, self._client
        linear, angular = (v_mps, 0.0, 0.0), (0.0, 0.0, w_radps)
        for _ in range(steps):
            _get_pose(body, client)
            _set_velocity(body, linear, angular, client)
            _step_once(client)

    def _run(self, end: int) -> None:
        """Step until `end` or until the drive rests."""
        body, client, servo, walls = self._body, self._client, self.servo, self._walls
        x, y, qz, qw = self._x, self._y, self._qz, self._qw
        first = step = self.step
        turning, ch, sh, angular = 0.0, 1.0, 0.0, (0.0, 0.0, 0.0)
        next_sample = step - step % SAMPLE_STEPS + SAMPLE_STEPS
        v, w, moving, alike = servo.v_mps, servo.w_radps, True, False
        while step < end and moving:
            if not servo.steady:
                v, w = servo.step()
                moving = not servo.resting
            if w != turning:
                # Half of the step's turn ahead, along the chord of the arc: circles close to second order.
                turning, ch, sh, angular = w, cos(_HALF_S * w), sin(_HALF_S * w), (0.0, 0.0, w)
            c, s = qw * qw - qz * qz, 2.0 * qw * qz
            vx, vy = v * (c * ch - s * sh), v * (s * ch + c * sh)
            if walls and not (0.0 <= x + vx * STEP_S <= WINDOW_M and 0.0 <= y + vy * STEP_S <= WINDOW_M):
                vx = self._held(step + 1, x, vx, "left", "right")
                vy = self._held(step + 1, y, vy, "bottom", "top")
            linear, heading = (vx, vy, 0.0), (qz, qw)
            for _ in range(min(next_sample, end) - step if alike else 1):
                _set_velocity(body, linear, angular, client)
                _step_once(client)
                step += 1
            (x, y, _), (_, _, qz, qw) = _get_pose(body, client)
            # On the spot no heading is needed; one that a straight step left as it was, the next leaves, too.
            alike = servo.steady and (not v or (not w and heading == (qz, qw))) and self._is_free(x, y, v)
            if step in (next_sample, end) or not moving:
                self.step, self._x, self._y, self._qz, self._qw = step, x, y, qz, qw
                self._vx, self._vy = vx, vy
                if step == next_sample or not moving:
                    next_sample += SAMPLE_STEPS
                    self.observe()
        self.steps_run += step - first

    def _is_free(self, x: float, y: float, v: float) -> bool:
        """Return whether no wall can be reached between two samples."""
        reach = _CLEARANCE_M + abs(v) * SAMPLE_STEPS * STEP_S
        return not self._walls or (reach <= x <= WINDOW_M - reach and reach <= y <= WINDOW_M - reach)

    def _held(self, step: int, position: float, velocity: float, low: str, high: str) -> float:
        """Return one velocity component that ends within the window; note the wall it leans on."""
        aim = position + velocity * STEP_S
        bound = _within(aim)
        if aim == bound:
            return velocity
        if abs(aim - bound) > _TOUCH_M:
            self._watcher.contact(step, low if aim < bound else high)
        return (bound - position) / STEP_S

    def observe(self) -> None:
        """Hand the watcher the measured state at the present step."""
        x, y, qz, qw = self._x, self._y, self._qz, self._qw
        if self._walls and not (0.0 <= x <= WINDOW_M and 0.0 <= y <= WINDOW_M):
            x, y = _within(x), _within(y)
        yaw = 2.0 * atan2(qz, qw)
        v = w = 0.0
        if not self.servo.resting:
            (vx, vy, _), (_, _, w) = _get_velocity(self._body, self._client)
            v = vx * (qw * qw - qz * qz) + vy * 2.0 * qw * qz
        if not isfinite(x + y + yaw + v + w):
            raise InfrastructureError("the simulated car left the realm of numbers")
        self._watcher.sample(self.step, (x, y, yaw), v, w)

    def _place(self, pose: PlanarPose) -> None:
        x, y, heading = pose
        if self._walls:
            x, y = _within(x), _within(y)
        self._x, self._y = x, y
        self._qz, self._qw = sin(heading / 2.0), cos(heading / 2.0)
        _bullet.resetBasePositionAndOrientation(
            self._body, (x, y, RIDE_HEIGHT_M), (0.0, 0.0, self._qz, self._qw), physicsClientId=self._client
        )


@contextmanager
def _faults() -> Iterator[None]:
    """Turn PyBullet's own exception into the grader's."""
    try:
        yield
    except _bullet.error as error:
        raise InfrastructureError(f"PyBullet: {error}") from error


def _within(position_m: float) -> float:
    return min(max(position_m, 0.0), WINDOW_M)


def _build(client: int) -> int:
    """Lay the floor in an empty world and load the car; return its body. About 2 ms."""
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
