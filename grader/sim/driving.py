"""The car that a script commands: turtlesim's law moves it, or its body where the car is rough."""

from math import cos, isfinite, sin
from typing import TYPE_CHECKING, Final, Protocol

from grader.contracts.assignment import WINDOW_M, Profile
from grader.contracts.errors import InfrastructureError
from grader.sim.car import (
    STEP_S,
    UPDATE_NS,
    UPDATE_S,
    WIDE_TURN_RAD,
    PlanarPose,
    RoughDrive,
    cos_sin,
    fold,
    last_step_at,
    step_time_ns,
    turtlesim_update,
)

if TYPE_CHECKING:
    from grader.sim.bullet import CarBody

CAR_MODEL: Final = 3  # raised whenever the same commands may give another trajectory

_HALF_S: Final = STEP_S / 2.0
_TOUCH_M: Final = 1e-6  # a wall pushed by less is not being pushed: the car slides along it
_BEHIND_UPDATES: Final = 8  # taken along at each update, the body costs a grading a quarter of its time
_QUICK_RADPS: Final = WIDE_TURN_RAD / (_BEHIND_UPDATES * UPDATE_S)
_QUICK_MPS: Final = 5.0  # wheels that are faster tilt the body, the more the longer an engine step is


class Watcher(Protocol):
    """Receives what the car does, while it does it."""

    def sample(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Take the state at the update of `t_ns`, and the velocity with which the update reached it."""

    def jump(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        """Take the state into which the car was put after the update of `t_ns`."""

    def contact(self, start_ns: int, end_ns: int, wall: str) -> None:
        """Learn that `wall` held the car back from `start_ns` to `end_ns`."""


class Car:
    """A car, driven in turtlesim's updates of 16 ms.

    One object serves any number of episodes, one after the other: the same commands give the same bits.

    The nominal car moves by turtlesim's law to the last bit. Where PyBullet is installed, its body is given the
    velocity that takes it along at each eighth update, at each one of a quick car, and when it comes to rest, and
    must be found where the law says; nothing else depends on it. The rough car is where physics takes its body.
    Walls are turtlesim's: the position is held within the window, component by component, and the heading is not
    affected.

    Attributes:
        now_ns: instant of the update the state stands at.
        pose: the car's at that instant.
        velocity: (v, w) at which the wheels turned in that update, whether or not a wall was in the way.
        resting: stopped, told to stay so, and seen at rest: updates would change nothing.
        lost: whether the pose is not a number, as a teleport may leave it. Nobody watches the car meanwhile.
        body_pose: where PyBullet has the body, at the last whole step before that instant; that of the nominal car
            may be seven updates behind while it drives.
        steps_run: steps of 1/240 s simulated since `reset`; those of a resting car are not.
        commanded: the twist that acts from the next update on.
    """

    def __init__(self, *, has_body: bool = True) -> None:
        """Make the car, and the world of its body. Raises InfrastructureError: PyBullet failed."""
        self._body = _body() if has_body else None
        self._walls = False
        self._rough: RoughDrive | None = None
        self._measured = (0.0, 0.0)
        self.pose: PlanarPose = (0.0, 0.0, 0.0)
        self.velocity = self.commanded = (0.0, 0.0)
        self.now_ns = self.steps_run = 0
        self.resting = True
        self.lost = False
        self._beyond: PlanarPose | None = None  # where the next update begins, outside the walls

    def close(self) -> None:
        """Give the body back. Nothing else is usable afterwards."""
        if self._body is not None:
            self._body.close()

    @property
    def body_pose(self) -> PlanarPose:
        """Where PyBullet has the body; of a car without one, where the law has it."""
        return self.pose if self._body is None else self._body.pose

    def reset(self, watcher: Watcher, start: PlanarPose, *, profile: Profile, walls: bool, seed: int) -> None:
        """Start an episode at time 0 with the car at rest in pose `start`.

        Raises InfrastructureError: PyBullet failed.
        """
        self._watcher = watcher
        self._walls = walls
        self._rough = RoughDrive(seed) if profile == "rough" else None
        self.velocity = self.commanded = self._measured = (0.0, 0.0)
        self.now_ns = self.steps_run = 0
        self.resting = True
        self.lost, self._beyond = False, None
        if self._body is not None:
            self._body.reset()
        self._place(start)
        self.observe()

    def command(self, v_mps: float, w_radps: float) -> None:
        """Command (v, w) from the next update on; it must be within the bounds of `clamp_command`."""
        if (v_mps, w_radps) == self.commanded:
            return
        if self.resting:
            self.observe()  # the end of the rest: before it, the car stood still
            self.resting = False
            if self._body is not None:
                self._body.wait_until(self.now_ns)
        self.commanded = (v_mps, w_radps)
        if self._rough is not None and self._body is not None:
            self._rough.aim(v_mps, w_radps)
            self._body.turn_wheels(v_mps, w_radps)

    def advance(self, t_ns: int) -> None:
        """Run every update up to `t_ns` under the present command. A resting car gets there without them.

        Raises InfrastructureError: PyBullet failed, or the car is not where it should be.
        """
        if not self.resting and self.now_ns + UPDATE_NS <= t_ns:
            first = last_step_at(self.now_ns)
            if self._rough is None or self._body is None:
                self._follow_the_law(t_ns)
            else:
                self._drive(self._rough, self._body, t_ns)
            self.steps_run += last_step_at(self.now_ns) - first
        self.now_ns = max(self.now_ns, t_ns - t_ns % UPDATE_NS)

    def put(self, pose: PlanarPose) -> None:
        """Take the car up and put it down in `pose`, after the present update; its velocity is kept.

        A nominal car that drives may be put outside the walls: its next update moves it from there, then holds it.
        """
        self.observe()
        self.lost = not isfinite(sum(pose))
        if self.lost:
            self.pose = pose
            return
        pose = (pose[0], pose[1], fold(pose[2]))
        self._place(pose)
        self._watcher.jump(self.now_ns, self.pose, *self._measured)
        self._beyond = None if self.resting or self._rough is not None else pose

    def stop_dead(self) -> None:
        """Take all velocity away at once, as for a robot that is removed or made anew."""
        self.command(0.0, 0.0)
        if self._rough is not None:
            self._rough.halt()
        self._measured = (0.0, 0.0)

    def observe(self) -> None:
        """Hand the watcher the state at the present update."""
        if not self.lost:
            self._watcher.sample(self.now_ns, self.pose, *self._measured)

    def _follow_the_law(self, t_ns: int) -> None:
        """Move by turtlesim's law up to `t_ns`, or to rest; let the body follow now and then."""
        v, w = self.velocity = self.commanded
        self.resting = v == w == 0.0
        each_time = self.resting or abs(v) > _QUICK_MPS or abs(w) > _QUICK_RADPS
        last_ns = self.now_ns + UPDATE_NS if self.resting else t_ns
        body = None if self.lost else self._body
        before, (begin, self._beyond) = self.pose, (self._beyond or self.pose, None)
        for now_ns in range(self.now_ns + UPDATE_NS, last_ns + 1, UPDATE_NS):
            pose, self._measured = turtlesim_update(begin, v, w), (v, w)
            if self._walls and not (0.0 <= pose[0] <= WINDOW_M and 0.0 <= pose[1] <= WINDOW_M):
                pose = self._held_within(before, pose, now_ns)
            if body is not None and (each_time or now_ns % (_BEHIND_UPDATES * UPDATE_NS) == 0):
                body.turn_wheels(v, w)
                body.follow(before, pose, now_ns)
            if not self.lost:
                self._watcher.sample(now_ns, pose, *self._measured)
            before = begin = pose
        self.pose, self.now_ns = before, now_ns
        if not self.lost:
            self._check()

    def _held_within(self, before: PlanarPose, aim: PlanarPose, now_ns: int) -> PlanarPose:
        """Return where the walls hold a car that an update wants elsewhere; the way there is what it measures."""
        start_ns = now_ns - UPDATE_NS
        x = self._held(start_ns, now_ns, aim[0], "left", "right")
        y = self._held(start_ns, now_ns, aim[1], "bottom", "top")
        if not self.lost:
            c, s = cos_sin(aim[2])
            way_m = (x - before[0]) * c + (y - before[1]) * s
            self._measured = (way_m / UPDATE_S, self._measured[1])
        return x, y, aim[2]

    def _check(self) -> None:
        """Raise if the car left the realm of numbers: once it has, no update brings it back."""
        if not isfinite(sum(self.pose) + sum(self._measured)):
            raise InfrastructureError("the simulated car left the realm of numbers")

    def _drive(self, rough: RoughDrive, body: "CarBody", t_ns: int) -> None:
        """Run the updates up to `t_ns`, or to rest, under the rough drive."""
        while not self.resting and self.now_ns + UPDATE_NS <= t_ns:
            first = last_step_at(self.now_ns)
            self.now_ns += UPDATE_NS
            self._step(rough, body, first, last_step_at(self.now_ns))
            self._check()
            self._watcher.sample(self.now_ns, self.pose, *self._measured)

    def _step(self, rough: RoughDrive, body: "CarBody", first: int, last: int) -> None:
        """Step the body under the rough drive from step `first` to step `last`."""
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
            x, y, heading = body.push(vx, vy, w)
        if self._walls:
            x, y = _within(x), _within(y)
        self.pose = (x, y, heading)
        self.velocity = (rough.v_mps, rough.w_radps)
        self.resting = rough.resting
        self._measured = (0.0, 0.0) if rough.resting else body.velocity()

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
        self.pose = (x, y, heading)
        if self._body is not None:
            self._body.place(self.pose, self.now_ns)


def _body() -> "CarBody | None":
    """Return a body for a car; None where PyBullet is not installed."""
    try:
        from grader.sim.bullet import CarBody
    except ModuleNotFoundError:
        return None
    return CarBody()


def _within(position_m: float) -> float:
    return min(max(position_m, 0.0), WINDOW_M)
