"""What a replay of a script's PyBullet calls showed: the account that is scored, nothing that the script says."""

from dataclasses import dataclass
from typing import Literal, get_args

from grader.contracts.record import Record
from grader.contracts.trajectory import Floats, Ints, Picture

TrickKind = Literal["jump", "push", "constraint", "dynamics", "collision", "gravity", "time_step", "removed"]
TRICKS: tuple[str, ...] = get_args(TrickKind)
ReplayEnd = Literal["complete", "crashed", "too_slow", "too_many_bodies", "not_finite"]


class Trick(Record):
    """A call that changes the world in a way that no motor does. What comes after it is not scored.

    Attributes:
        name: of PyBullet's function. call: its number among all recorded calls.
        t_ns: simulated time at which it came. before_start: it came before the first step.
    """

    kind: TrickKind
    name: str
    call: int
    t_ns: int
    before_start: bool


class ReplayedBody(Record):
    """A body of the world.

    Attributes:
        role: ``object`` and ``robot`` are what the assignment looks at.
        file: what it was loaded from, as the script wrote it; empty: made of shapes.
        mass_kg: of its base; 0: fixed. total_kg: of all links together.
        is_late: it came after the first step.
    """

    id: int
    role: Literal["", "object", "robot"] = ""
    file: str = ""
    joints: int = 0
    mass_kg: float = 0.0
    total_kg: float = 0.0
    is_late: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Replayed:
    """A replayed world, sampled 60 times a simulated second and at its end.

    Attributes:
        end: how the replay ended.
        steps: of the simulation. calls: recorded ones.
        gravity: before the first step, as the engine had it, in m/s².
        t_ns: (n,) simulated time of the samples. calls_at: (n,) how many calls came before each.
        object: (n, 13) position, quaternion, velocity, spin of the object; NaN where it was not there.
        object_joints: (n, k) its joints. power_w: (n,) what its motors do.
        link: (n, 7) position and quaternion of the robot's link; NaN where it was not there.
        base: (n, 3) position of the robot's base.
        robot_joints: (n, m) its joints.
        pushes: for each sample, (body, link, newtons) of what touches the object, or else the robot.
        state: SHA-256 of all bodies' last states; empty where the script had disconnected.
    """

    end: ReplayEnd
    steps: int
    calls: int
    gravity: tuple[float, float, float]
    t_ns: Ints
    calls_at: Ints
    object: Floats
    object_joints: Floats
    power_w: Floats
    link: Floats
    base: Floats
    robot_joints: Floats
    pushes: tuple[tuple[tuple[int, int, float], ...], ...] = ()
    bodies: tuple[ReplayedBody, ...] = ()
    tricks: tuple[Trick, ...] = ()
    pictures: tuple[Picture, ...] = ()
    state: str = ""
