"""What the checks on motion share: what was commanded, the driven path, the part that counts, and how it ended."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Run
from grader.contracts.trajectory import COMMAND_LIFE_NS, Command, Contact, Ints, Trajectory
from grader.geometry import exact
from grader.geometry.path import Path, driven_path

# Slower than this counts as rest, because a car that settles keeps creeping.
MOVING_MPS = 0.02
MOVING_RADPS = 0.02

FAST_TURN_RADPS = 12.0  # nobody wants to turn twice a second: this is a number of degrees

# A longer rest before the horizon is the end of the motion, not a pause in it, unless the script rested as long
# between two motions before. Scripts that pause between motions do so for up to a second.
MAX_PAUSE_NS = 1_500_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """The motion of one run, as far as it counts.

    Attributes:
        path: the driven path. t_ns: (n,) the time of its samples.
        moving_at_end: the car was moving when the recording ended.
        cut_short: moving at the end, or in a pause between motions when the horizon came.
    """

    path: Path
    t_ns: Ints
    moving_at_end: bool
    cut_short: bool


def fastest_radps(run: Run) -> float:
    """Return the highest turn rate, to either side, that was commanded; 0 without commands."""
    return max((abs(command.w_radps) for command in run.trajectory.commands), default=0.0)


def drive_of(run: Run, *, until_contact: bool = False) -> Drive | None:
    """Return the motion of `run`, or None when the trajectory is empty or not finite.

    `until_contact`: without what came after the car first touched a wall.
    """
    trajectory = run.trajectory
    count = _counted(trajectory, until_contact=until_contact)
    poses = (trajectory.x_m, trajectory.y_m, trajectory.heading_rad)
    if count < 1 or not all(bool(np.isfinite(column[:count]).all()) for column in poses):
        return None
    moving = _moving_at_end(trajectory)
    return Drive(
        path=path_of(trajectory, count),
        t_ns=trajectory.t_ns[:count],
        moving_at_end=moving,
        cut_short=moving or _pausing(run),
    )


@lru_cache(maxsize=2)  # of a run as driven and as commanded; what measures and what explains ask again
def path_of(trajectory: Trajectory, count: int) -> Path:
    """Return the path of the first `count` samples."""
    jumps = [i for i in trajectory.jumps if 0 < i < count]
    return driven_path(trajectory.x_m[:count], trajectory.y_m[:count], trajectory.heading_rad[:count], jumps)


def is_drive(command: Command) -> bool:
    """Whether the command asks for a speed worth the name, straight on or in an arc."""
    return abs(command.v_mps) > MOVING_MPS


def is_turn(command: Command) -> bool:
    """Whether the command asks for a turn worth the name, on the spot or in an arc."""
    return abs(command.w_radps) > MOVING_RADPS


def is_motion(command: Command) -> bool:
    """Whether the command asks for a motion worth the name."""
    return abs(command.v_mps) > MOVING_MPS or abs(command.w_radps) > MOVING_RADPS  # asked most: no more calls


@lru_cache(maxsize=1)  # most looks for mistakes ask for these commands, run by run
def moves_of(trajectory: Trajectory) -> tuple[Command, ...]:
    """Return the commands that ask for a motion; a script that steers by the pose sends as many others."""
    return tuple(filter(is_motion, trajectory.commands))


@lru_cache(maxsize=1)  # as `moves_of`
def with_ends(trajectory: Trajectory) -> tuple[tuple[Command, int], ...]:
    """Return each command with the time at which it ended: at the next command, or when turtlesim dropped it."""
    commands = trajectory.commands
    dropped_ns = [command.t_ns + COMMAND_LIFE_NS for command in commands]
    next_ns = [*(command.t_ns for command in commands[1:]), *dropped_ns[-1:]]
    return tuple(zip(commands, map(min, next_ns, dropped_ns), strict=True))


def pushed_m(trajectory: Trajectory, until_ns: int) -> float:
    """Return the longest way that a wall kept the car from driving, as commanded, up to `until_ns`."""
    return max(
        (_pushed_m(trajectory, contact) for contact in trajectory.contacts if contact.start_ns <= until_ns),
        default=0.0,
    )


def _pushed_m(trajectory: Trajectory, contact: Contact) -> float:
    at = min(int(np.searchsorted(trajectory.t_ns, contact.start_ns)), len(trajectory) - 1)
    heading_rad = float(trajectory.heading_rad[at])
    cos, sin = exact.cos_sin(heading_rad)
    across = cos if contact.wall in ("left", "right") else sin
    speeds = (command.v_mps for command in reversed(trajectory.commands) if command.t_ns <= contact.start_ns)
    return abs(across * next(speeds, 0.0)) * (contact.end_ns - contact.start_ns) / 1e9


def _counted(trajectory: Trajectory, *, until_contact: bool) -> int:
    if not until_contact or not trajectory.contacts or len(trajectory) == 0:
        return len(trajectory)
    before = int(np.searchsorted(trajectory.t_ns, trajectory.contacts[0].start_ns, side="left"))
    return max(before, 1)


def _moving_at_end(trajectory: Trajectory) -> bool:
    recorded_to_the_end = trajectory.end_ns - int(trajectory.t_ns[-1]) <= 100_000_000
    moving = abs(trajectory.v_mps[-1]) > MOVING_MPS or abs(trajectory.w_radps[-1]) > MOVING_RADPS
    return recorded_to_the_end and bool(moving)


def _pausing(run: Run) -> bool:
    trajectory = run.trajectory
    if run.outcome.status is not RunStatus.INTERRUPTED or run.outcome.last_command_ns is None:
        return False
    rested_ns = trajectory.end_ns - _last_driven_ns(trajectory)
    return rested_ns <= MAX_PAUSE_NS or rested_ns <= _longest_rest_ns(trajectory)


def _longest_rest_ns(trajectory: Trajectory) -> int:
    """Return the longest time between two motions of the car."""
    t_ns = trajectory.t_ns[_is_moving(trajectory)]
    return int(np.max(np.diff(t_ns))) if len(t_ns) > 1 else 0


def _is_moving(trajectory: Trajectory) -> NDArray[np.bool_]:
    moving: NDArray[np.bool_] = (np.abs(trajectory.v_mps) > MOVING_MPS) | (
        np.abs(trajectory.w_radps) > MOVING_RADPS
    )
    return moving


def _last_driven_ns(trajectory: Trajectory) -> int:
    """Return when the car last moved or was last commanded to: at a wall it stands still under a command.

    A script that keeps publishing zero until the horizon counts as at rest.
    """
    moving = _is_moving(trajectory)
    commanded = [command.t_ns for command in moves_of(trajectory)[-1:]]
    return max(int(t_ns) for t_ns in (*trajectory.t_ns[moving][-1:], *commanded, 0))
