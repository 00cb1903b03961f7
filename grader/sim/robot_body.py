"""The robot's body in a room, in PyBullet: friction, contacts and mass do the work."""

import math
from collections.abc import Iterable
from typing import Any, Final

import pybullet as _bullet

from grader.contracts.assignment import Room, Solid
from grader.contracts.errors import InfrastructureError
from grader.contracts.robot import SCANNER_X_M, SCANNER_Z_M, WHEEL_RADIUS_M
from grader.sim.bullet import Client, faults
from grader.sim.car import STEP_S, PlanarPose, step_time_ns
from grader.sim.driving import Watcher
from grader.sim.robot import (
    BEAT_S,
    DRIVE_BEATS,
    DRIVE_S,
    ROBOT_URDF,
    STEPS_PER_BEAT,
    Odometry,
    WheelDrive,
    beat_time_ns,
    last_beat_at,
)

_step_once: Final = _bullet.stepSimulation
_get_pose: Final = _bullet.getBasePositionAndOrientation
_touching: Final = _bullet.getContactPoints


_GRAVITY_MPS2: Final = -9.81
_SOLVER_ITERATIONS: Final = 8  # fewer let the wheels slide on after a stop; see docs/simulator.md
_WHEELS: Final = (0, 1)
_TORQUES_NM: Final = (1.0, 1.0)
_MASS_X_M, _MASS_Z_M = -0.03, 0.055  # of the centre of mass in the base's frame, as the URDF has it
_SETTLING_STEPS: Final = 24  # 0.1 s in which the robot sinks onto the floor, before time starts
_RAY, _FLOOR, _WALL, _RAMP, _OUTLINE, _TYRE = 1, 2, 4, 8, 16, 32  # groups for collision filters
_BOUNCE_NS: Final = 250_000_000  # contacts of one solid that are no further apart are one: a robot bounces
_STILL_MPS, _STILL_RADPS = 5e-4, 2e-3  # the solver makes a stopped robot creep by a quarter of that
_LEVEL: Final = 0.004  # of the quaternion's x and y: half a degree
_FAR_M: Final = 1_000.0  # no room is so large: a pose beyond it means that the physics broke down
_OTHER, _FORCE_N = 2, 9  # indices in PyBullet's tuple of a contact point


class RobotBody(Client):
    """A robot in a PyBullet world of its own, driven beat by beat.

    One object serves any number of episodes, one after the other: `reset` builds the world anew.

    Attributes:
        beat: the last beat advanced to; `now_ns` is its instant.
        pose: of the point on the floor below the middle of the axle.
        velocity: (v, w) measured over the last beat.
        wheels_rad: how far the wheels have turned, left and right, as their sensors tell.
        odometry: the pose that the wheels' sensors add up to.
        commanded: the twist that acts from the next tick of the drive on.
        resting: at rest under a zero command, so that beats would change nothing.
        steps_run: physics steps computed.
    """

    def __init__(self) -> None:
        super().__init__()
        self._used = False

    def reset(self, watcher: Watcher, start: PlanarPose, room: Room, *, rough_seed: int | None) -> None:
        """Start an episode at time 0 with the robot at rest in pose `start`.

        Args:
            watcher: receives what the robot does.
            start: x and y in m, heading in rad.
            room: what stands around it.
            rough_seed: draws how its wheels differ; None: they do not.

        Raises:
            InfrastructureError: PyBullet failed.
        """
        self._watcher = watcher
        self._drive = WheelDrive(rough_seed)
        self.commanded = self.velocity = self.wheels_rad = (0.0, 0.0)
        self.beat = self.now_ns = self.steps_run = 0
        self.odometry = Odometry(start)
        self._zero_rad = (0.0, 0.0)
        self._touched: dict[int, int] = {}
        with faults():
            if self._used:
                _bullet.resetSimulation(physicsClientId=self._client)
            self._used = True
            self._body = _build_world(self._client, start)
            self._names = {
                _add_solid(self._client, solid): name
                for solid, name in zip(room.solids, names_of(room.solids), strict=True)
            }
            for _ in range(_SETTLING_STEPS):
                _step_once(self._client)
            self._zero_rad = self._angles()
            self._locate()
        self.resting = True
        self.observe()

    def command(self, v_mps: float, w_radps: float) -> None:
        """Command (v, w) from the next tick of the drive on; it must be within the robot's bounds."""
        if (v_mps, w_radps) == self.commanded:
            return
        if self.resting:
            self.observe()  # the end of the rest, during which nothing was sampled
            self.resting = False
        self.commanded = (v_mps, w_radps)
        self._drive.aim(v_mps, w_radps)

    def advance(self, t_ns: int) -> None:
        """Go on to the last beat at or before `t_ns`. A resting robot gets there without physics.

        Raises InfrastructureError: PyBullet failed, or the robot's pose is not finite.
        """
        last = last_beat_at(t_ns)
        if not self.resting:
            with faults():
                while self.beat < last and not self.resting:
                    self._beat()
        if self.beat < last:
            self.beat, self.now_ns = last, beat_time_ns(last)

    def observe(self) -> None:
        """Hand the watcher the state at the present beat."""
        self._watcher.sample(self.now_ns, self.pose, *self.velocity)

    @property
    def level(self) -> bool:
        """Whether the robot stands on the plain floor."""
        return bool(abs(self._tilt[0]) < _LEVEL and abs(self._tilt[1]) < _LEVEL)

    def scan_m(self, angles_rad: Iterable[float], most_m: float) -> list[float]:
        """Return what a scanner on the tilted robot measures: the engine's own rays, all in one batch."""
        at, turned = _get_pose(self._body, self._client)
        own = (SCANNER_X_M - _MASS_X_M, 0.0, SCANNER_Z_M - WHEEL_RADIUS_M - _MASS_Z_M)
        origin, _ = _bullet.multiplyTransforms(at, turned, own, (0.0, 0.0, 0.0, 1.0))
        ends = [
            _bullet.multiplyTransforms(
                origin, turned, (most_m * math.cos(a), most_m * math.sin(a), 0.0), (0.0, 0.0, 0.0, 1.0)
            )[0]
            for a in angles_rad
        ]
        hits = _bullet.rayTestBatch(
            [origin] * len(ends),
            ends,
            collisionFilterMask=_FLOOR | _WALL | _RAMP,
            physicsClientId=self._client,
        )
        return [math.inf if hit[0] < 0 else most_m * float(hit[2]) for hit in hits]

    def _beat(self) -> None:
        client, first = self._client, self.beat * STEPS_PER_BEAT
        drives = self.beat % DRIVE_BEATS == 0
        if drives and not self._drive.settled:
            self._steer()
        for step in range(first, first + STEPS_PER_BEAT):
            _step_once(client)
            if touched := _touching(self._body, -1, -1, -2, client):
                self._note_contacts(touched, step)
        self.steps_run += STEPS_PER_BEAT
        before = self.pose
        self.beat += 1
        self.now_ns = beat_time_ns(self.beat)
        self._locate()
        self._measure(before)
        self.observe()
        if self.beat % DRIVE_BEATS == 0:
            self.odometry.update(*self.wheels_rad, DRIVE_S)
            if self.commanded == (0.0, 0.0):
                self._rest_if_still()

    def _steer(self) -> None:
        rates = self._drive.tick()
        _bullet.setJointMotorControlArray(
            self._body,
            _WHEELS,
            _bullet.VELOCITY_CONTROL,
            targetVelocities=[rate * radius for rate, radius in zip(rates, self._drive.radii, strict=True)],
            forces=_TORQUES_NM,
            physicsClientId=self._client,
        )

    def _locate(self) -> None:
        (x, y, z), (qx, qy, qz, qw) = _get_pose(self._body, self._client)
        # From the centre of mass to the axle's middle, in the robot's own frame turned by its orientation.
        ax, az = -_MASS_X_M, -_MASS_Z_M
        x += ax * (1.0 - 2.0 * (qy * qy + qz * qz)) + az * 2.0 * (qx * qz + qy * qw)
        y += ax * 2.0 * (qx * qy + qz * qw) + az * 2.0 * (qy * qz - qx * qw)
        heading = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
        if not abs(x) + abs(y) + abs(z) < _FAR_M:
            raise InfrastructureError("the simulated robot left the realm of numbers")
        self.pose = (x, y, heading)
        self._tilt = (qx, qy)
        left, right = self._angles()
        zero, radii = self._zero_rad, self._drive.radii
        self.wheels_rad = ((left - zero[0]) / radii[0], (right - zero[1]) / radii[1])

    def _angles(self) -> tuple[float, float]:
        (left, *_), (right, *_) = _bullet.getJointStates(self._body, _WHEELS, physicsClientId=self._client)
        return left, right

    def _measure(self, before: PlanarPose) -> None:
        dx, dy = self.pose[0] - before[0], self.pose[1] - before[1]
        turned = math.remainder(self.pose[2] - before[2], math.tau)
        middle = before[2] + 0.5 * turned
        self.velocity = ((dx * math.cos(middle) + dy * math.sin(middle)) / BEAT_S, turned / BEAT_S)

    def _rest_if_still(self) -> None:
        """Begin a rest if the robot, which is commanded to stand still, does."""
        v, w = self.velocity
        still = abs(v) < _STILL_MPS and abs(w) < _STILL_RADPS
        if still and self._drive.settled:
            self.velocity = (0.0, 0.0)
            self.odometry.update(*self.wheels_rad, DRIVE_S)  # the same angles again: its speeds become zero
            self.resting = True

    def _note_contacts(self, touched: Iterable[tuple[Any, ...]], step: int) -> None:
        """Note each solid that pushes against the outline in physics step `step`."""
        start_ns, end_ns = step_time_ns(step), step_time_ns(step + 1)
        for body in sorted({point[_OTHER] for point in touched if point[_FORCE_N] > 0.0}):
            last_ns = self._touched.get(body, start_ns)
            self._touched[body] = end_ns
            begin_ns = last_ns if start_ns - last_ns <= _BOUNCE_NS else start_ns
            self._watcher.contact(begin_ns, end_ns, self._names[body])


def names_of(solids: Iterable[Solid]) -> list[str]:
    """Return the name of each solid in contacts: the side of an outer wall, else the solid's kind."""
    sides = iter(("left", "bottom", "right", "top"))  # the order in which a room lists its outer walls
    return [next(sides) if solid.kind == "edge" else solid.kind for solid in solids]


def _build_world(client: int, start: PlanarPose) -> int:
    """Lay the floor in an empty world and put the robot on it; return its body."""
    _bullet.setRealTimeSimulation(0, physicsClientId=client)
    _bullet.setPhysicsEngineParameter(
        fixedTimeStep=STEP_S,
        numSubSteps=0,
        numSolverIterations=_SOLVER_ITERATIONS,
        deterministicOverlappingPairs=1,
        enableConeFriction=1,  # the default, a pyramid, steers a robot that drives diagonally
        physicsClientId=client,
    )
    _bullet.setGravity(0.0, 0.0, _GRAVITY_MPS2, physicsClientId=client)
    shape = _bullet.createCollisionShape(_bullet.GEOM_PLANE, physicsClientId=client)
    floor = _bullet.createMultiBody(0.0, shape, physicsClientId=client)
    _bullet.changeDynamics(floor, -1, lateralFriction=1.0, physicsClientId=client)
    _bullet.setCollisionFilterGroupMask(floor, -1, _FLOOR, _RAY | _TYRE, physicsClientId=client)
    x, y, heading = start
    body: int = _bullet.loadURDF(
        str(ROBOT_URDF),
        (x, y, WHEEL_RADIUS_M),
        (0.0, 0.0, math.sin(heading / 2.0), math.cos(heading / 2.0)),
        flags=_bullet.URDF_USE_INERTIA_FROM_FILE,
        physicsClientId=client,
    )
    _bullet.changeDynamics(body, -1, linearDamping=0.0, angularDamping=0.0, physicsClientId=client)
    _bullet.setCollisionFilterGroupMask(body, -1, _OUTLINE, _WALL | _RAMP, physicsClientId=client)
    for link in range(_bullet.getNumJoints(body, physicsClientId=client)):
        _bullet.setCollisionFilterGroupMask(body, link, _TYRE, _FLOOR | _RAMP, physicsClientId=client)
    _bullet.setJointMotorControlArray(
        body,
        _WHEELS,
        _bullet.VELOCITY_CONTROL,
        targetVelocities=(0.0, 0.0),
        forces=_TORQUES_NM,
        physicsClientId=client,
    )
    return body


def _add_solid(client: int, solid: Solid) -> int:
    """Put a solid into the world; return its body."""
    half = (solid.length_m / 2.0, solid.width_m / 2.0, solid.height_m / 2.0)
    if solid.kind == "cylinder":
        shape = _bullet.createCollisionShape(
            _bullet.GEOM_CYLINDER, radius=half[0], height=solid.height_m, physicsClientId=client
        )
    elif solid.kind == "ramp":
        rise = [(-half[0], side, -half[2]) for side in (-half[1], half[1])]
        rise += [(half[0], side, z) for side in (-half[1], half[1]) for z in (-half[2], half[2])]
        shape = _bullet.createCollisionShape(_bullet.GEOM_MESH, vertices=rise, physicsClientId=client)
    else:
        shape = _bullet.createCollisionShape(_bullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
    turn = math.radians(solid.heading_deg) / 2.0
    body: int = _bullet.createMultiBody(
        0.0,
        shape,
        basePosition=(solid.x_m, solid.y_m, half[2]),
        baseOrientation=(0.0, 0.0, math.sin(turn), math.cos(turn)),
        physicsClientId=client,
    )
    _bullet.changeDynamics(body, -1, lateralFriction=1.0, physicsClientId=client)
    group, met = (_RAMP, _RAY | _OUTLINE | _TYRE) if solid.kind == "ramp" else (_WALL, _RAY | _OUTLINE)
    _bullet.setCollisionFilterGroupMask(body, -1, group, met, physicsClientId=client)
    return body
