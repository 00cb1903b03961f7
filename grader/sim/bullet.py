"""The car's body in PyBullet: it follows where the law has the car, or moves the car where physics takes it."""

import hashlib
import os
import sys
from array import array
from collections.abc import Iterator
from contextlib import contextmanager
from math import atan2, cos, hypot, sin
from typing import Final

from grader.contracts.errors import InfrastructureError
from grader.sim.car import (
    RIDE_HEIGHT_M,
    STEP_S,
    UPDATE_NS,
    URDF,
    WHEEL_RADIUS_M,
    WIDE_TURN_RAD,
    PlanarPose,
    fold,
    last_step_at,
    step_time_ns,
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

ENGINE: Final = f"Bullet {_bullet.getAPIVersion()}"
_SINES: Final = array("d", (sin(0.1 * i) + cos(0.3 * i) for i in range(1_000)))
ROUNDING: Final = f"libm {hashlib.sha256(_SINES.tobytes()).hexdigest()[:6]}"
"""How the C library rounds, which Bullet computes with: last bits differ with and without FMA. Contacts let them
grow, so a replay is sure to be repeated only where this is the same."""


_GRAVITY_MPS2: Final = -9.81
_SOLVER_ITERATIONS: Final = 4  # the wheels' and casters' contacts are four points: they converge in three
_WHEEL_JOINTS: Final = (0, 1)
_MOTORS_NM: Final = (0.1, 0.1)
_MAX_JOINT_RADPS: Final = 4_000.0  # PyBullet's own bound of 100 would hold the wheels back at 5 m/s
# In m and rad. The body stays within 1e-8; at 100 rad/s its wheels, as gyroscopes, tilt it by 5e-3.
_ASTRAY: Final = 0.05


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


class CarBody(Client):
    """The car's body in a PyBullet world of its own.

    One object serves any number of episodes: `reset` brings back the world that was built, contacts and all, so
    nothing of an earlier episode is left and the same calls give the same bits. The tyres and casters that carry
    the car have no friction and never steer it; the wheels' motors turn along.

    Attributes:
        pose: where the body is.
    """

    def __init__(self) -> None:
        """Connect to PyBullet and build the world, which takes 10 ms.

        Raises InfrastructureError: PyBullet failed.
        """
        super().__init__()
        with faults():
            self._body = _build(self._client)
            self._built: int = _bullet.saveState(physicsClientId=self._client)
        self._turned: tuple[float, float] | None = None  # unknown: a state that is brought back has no motors
        self._step = 0
        self.pose: PlanarPose = (0.0, 0.0, 0.0)

    def reset(self) -> None:
        """Bring back the world of a new episode, as it was built."""
        self._turned = None
        with faults():
            _bullet.restoreState(stateId=self._built, physicsClientId=self._client)
            _bullet.setTimeStep(STEP_S, physicsClientId=self._client)

    def place(self, pose: PlanarPose, now_ns: int) -> None:
        """Put the body down in `pose`."""
        self.pose = pose
        self.wait_until(now_ns)
        x, y, heading = pose
        orientation = (0.0, 0.0, sin(heading / 2.0), cos(heading / 2.0))
        with faults():
            _bullet.resetBasePositionAndOrientation(
                self._body, (x, y, RIDE_HEIGHT_M), orientation, physicsClientId=self._client
            )

    def wait_until(self, now_ns: int) -> None:
        """Let time pass up to `now_ns` without a step."""
        self._step = last_step_at(now_ns)

    def turn_wheels(self, v_mps: float, w_radps: float) -> None:
        """Have the motors turn the wheels at the speeds that this velocity needs."""
        if (v_mps, w_radps) == self._turned:
            return
        self._turned = (v_mps, w_radps)
        with faults():
            _bullet.setJointMotorControlArray(
                self._body,
                _WHEEL_JOINTS,
                _bullet.VELOCITY_CONTROL,
                targetVelocities=twist_to_wheels(v_mps, w_radps),
                forces=_MOTORS_NM,
                physicsClientId=self._client,
            )

    def follow(self, before: PlanarPose, after: PlanarPose, now_ns: int) -> None:
        """Come to where the car is at the last step, on the line from `before`, one update ago, to `after`, now.

        The velocity is constant meanwhile and no force acts along the floor, so that one engine step over all of
        the time does what its single steps would do.

        Raises InfrastructureError: the body does not get there, or PyBullet failed.
        """
        last = last_step_at(now_ns)
        steps, until_ns = last - self._step, step_time_ns(last)
        self._step = last
        body, client = self._body, self._client
        share = 1.0 - (now_ns - until_ns) / UPDATE_NS
        x = before[0] + (after[0] - before[0]) * share
        y = before[1] + (after[1] - before[1]) * share
        heading = before[2] + fold(after[2] - before[2]) * share
        at_x, at_y, at_heading = self.pose
        turn, seconds = fold(heading - at_heading), steps * STEP_S
        linear = ((x - at_x) / seconds, (y - at_y) / seconds, 0.0)
        engine_steps = 1 if abs(turn) < WIDE_TURN_RAD else steps
        try:
            _set_time_step(seconds / engine_steps, client)
            for _ in range(engine_steps):
                _set_velocity(body, linear, (0.0, 0.0, turn / seconds), client)
                _step_once(client)
            (at_x, at_y, _), (_, _, qz, qw) = _get_pose(body, client)
        except _bullet.error as error:
            raise _fault(error) from error
        self.pose = (at_x, at_y, 2.0 * atan2(qz, qw))
        if hypot(at_x - x, at_y - y) > _ASTRAY or abs(fold(self.pose[2] - heading)) > _ASTRAY:
            raise InfrastructureError("the simulated car's body is not where its law says")

    def push(self, vx_mps: float, vy_mps: float, w_radps: float) -> PlanarPose:
        """Move for one step at this velocity, in the world's frame; return where that takes the body.

        Raises InfrastructureError: PyBullet failed.
        """
        body, client = self._body, self._client
        try:
            _set_velocity(body, (vx_mps, vy_mps, 0.0), (0.0, 0.0, w_radps), client)
            _step_once(client)
            (x, y, _), (_, _, qz, qw) = _get_pose(body, client)
        except _bullet.error as error:
            raise _fault(error) from error
        self.pose = (x, y, 2.0 * atan2(qz, qw))
        return self.pose

    def velocity(self) -> tuple[float, float]:
        """Return (v, w): the speed along the heading, and the yaw rate."""
        with faults():
            (vx, vy, _), (_, _, w) = _get_velocity(self._body, self._client)
        heading = self.pose[2]
        return vx * cos(heading) + vy * sin(heading), w

    def run_bare(self, steps: int, v_mps: float, w_radps: float) -> None:
        """Drive `steps` steps of 1/240 s with only the three calls a step needs: the floor of benchmarks."""
        body, client = self._body, self._client
        linear, angular = (v_mps, 0.0, 0.0), (0.0, 0.0, w_radps)
        for _ in range(steps):
            _get_pose(body, client)
            _set_velocity(body, linear, angular, client)
            _step_once(client)


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
