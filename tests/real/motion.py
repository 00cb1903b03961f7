"""Compares how a script moves the turtle here with how it did on the real turtlesim, motion by motion.

Both are cut into motions by what each update did: a straight, a turn on the spot or an arc, in one sense. Compared
is what a student sees: how many motions there are, how far each goes and turns, and where the turtle ends.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grader.contracts.assignment import Assignment, Case
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.text import EMPTY
from grader.contracts.trajectory import Trajectory, decode_trajectory
from tests.real.recordings import Recording

UPDATE_S: Final = 0.016
SLACK_UPDATES: Final = 2
"""By so many updates a motion is off: where its beginning and its end fall between two updates is chance."""
SLEEP_SHARE: Final = 0.02
"""`sleep(0.01)` took up to 10.2 ms, and a slow update of turtlesim's lets a loop by the clock drive less."""
_JUMP_M, _JUMP_RAD = 0.3, 0.6  # in one update: a teleport
_STILL = 2e-6  # m or rad: what a message's 32 bits show of a turtle at rest
_SLIGHT_RAD = (
    1e-3  # an arc that turns less in an update is taken for a straight: a controller's ends in no time
)
_SLOW_SHARE = 0.04  # of a time: turtlesim's slowest run had 61.06 updates in a second, and sleeps are late
_ROUNDING = 1e-3  # m or rad: of a message's 32 bits, and of poses that were not received
_BRIEF = 2  # updates of a motion that chance makes and unmakes
_START_S = 1.0


class Motion(NamedTuple):
    """Successive updates that moved the turtle in one sense; `most` is what a single one of them did."""

    kind: str
    updates: int
    length_m: float
    turn_rad: float
    most_m: float
    most_rad: float


@dataclass(frozen=True, slots=True)
class Driven:
    """What a turtle did.

    Attributes:
        began_s: when it first moved, NaN if it never did. end: its last pose.
        jumps: how often it was teleported.
    """

    motions: tuple[Motion, ...]
    began_s: float
    ended_s: float
    end: tuple[float, float, float]
    jumps: int

    @property
    def turned_deg(self) -> float:
        """Sum of all turns."""
        return math.degrees(sum(each.turn_rad for each in self.motions))

    @property
    def length_m(self) -> float:
        """Length of the way."""
        return sum(abs(each.length_m) for each in self.motions)


def driven(
    t_s: NDArray[np.float64],
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    theta_rad: NDArray[np.float64],
) -> Driven:
    """Cut a series of poses into motions."""
    finite = np.isfinite(x_m + y_m + theta_rad)
    t_s, x_m, y_m, theta_rad = (each[finite] for each in (t_s, x_m, y_m, theta_rad))
    dx, dy, turned = np.diff(x_m), np.diff(y_m), np.diff(theta_rad)
    turned = (turned + np.pi) % (2.0 * np.pi) - np.pi
    ahead = dx * np.cos(theta_rad[1:]) + dy * np.sin(theta_rad[1:])
    gone = np.hypot(dx, dy) * np.where(ahead < 0.0, -1.0, 1.0)
    jumped = (np.abs(gone) > _JUMP_M) | (np.abs(turned) > _JUMP_RAD)
    kinds = [_kind(*each) for each in zip(gone, turned, jumped, strict=True)]
    moving = [i for i, kind in enumerate(kinds) if kind not in ("rest", "jump")]
    return Driven(
        motions=tuple(_motions(kinds, gone, turned)),
        began_s=float(t_s[moving[0] + 1]) if moving else math.nan,
        ended_s=float(t_s[moving[-1] + 1]) if moving else math.nan,
        end=(float(x_m[-1]), float(y_m[-1]), float(theta_rad[-1])),
        jumps=sum(kind == "jump" for kind in kinds),
    )


def _kind(gone: float, turned: float, jumped: bool) -> str:
    if jumped:
        return "jump"
    drives = "" if abs(gone) <= _STILL else "ahead" if gone > 0.0 else "back"
    turns = "" if abs(turned) <= (_SLIGHT_RAD if drives else _STILL) else "left" if turned > 0.0 else "right"
    return f"{drives} {turns}".strip() or "rest"


def _motions(kinds: list[str], gone: NDArray[np.float64], turned: NDArray[np.float64]) -> Iterator[Motion]:
    at = 0
    for kind, same in groupby(kinds):
        count = len(list(same))
        if kind not in ("rest", "jump"):
            here = slice(at, at + count)
            most_m, most_rad = np.abs(gone[here]).max(), np.abs(turned[here]).max()
            yield Motion(
                kind,
                count,
                float(gone[here].sum()),
                float(turned[here].sum()),
                float(most_m),
                float(most_rad),
            )
        at += count


def of_real(recording: Recording) -> Driven:
    """Return what the real turtle did up to Ctrl+C, where our episodes end."""
    poses = recording.poses
    assert poses is not None
    until_s = math.inf if recording.interrupted_at_s is None else recording.interrupted_at_s
    seen = poses.t_s <= max(until_s, float(poses.t_s[1]))
    return driven(poses.t_s[seen], poses.x_m[seen], poses.y_m[seen], poses.theta_rad[seen])


def of_ours(trajectory: Trajectory) -> Driven:
    """Return what ours did."""
    return driven(trajectory.t_ns / 1e9, trajectory.x_m, trajectory.y_m, trajectory.heading_rad)


def run(grader: Grader, recording: Recording, horizon_s: float) -> Trajectory:
    """Run a recording's script in turtlesim's window, with Ctrl+C at `horizon_s`."""
    assignment = Assignment(
        id="real",
        version=1,
        order=0,
        title=EMPTY,
        brief=EMPTY,
        check="node",
        items=(),
        horizon_s=horizon_s,
        cases=(Case(stdin=recording.stdin, args=recording.args),),
    )
    source = recording.script.read_bytes()
    job = GradingJob(file_name=recording.script.name, source=source, assignment=assignment)
    (trajectory,) = grader.grade(job).trajectories.values()
    return decode_trajectory(trajectory)


def differences(ours: Driven, real: Driven, twins: Sequence[Driven]) -> list[str]:
    """Say how ours differs from a real run by more than chance, and than its `twins`, of the same script, do."""
    wanted, got = _merged(real.motions), _merged(ours.motions)
    others = [_merged(twin.motions) for twin in twins]
    if _kinds(wanted) != _kinds(got):
        if any(_kinds(other) == _kinds(got) for other in others):
            return []
        return [
            f"{len(got)} motions ({', '.join(_kinds(got))}), not {len(wanted)} ({', '.join(_kinds(wanted))})"
        ]
    alike = [other for other in others if _kinds(other) == _kinds(wanted)]
    found, slack_rad, slack_m = [], 0.0, _ROUNDING
    for at, (one, other) in enumerate(zip(wanted, got, strict=True)):
        slack = SLACK_UPDATES + SLEEP_SHARE * one.updates
        slack += max((abs(twin[at].updates - one.updates) for twin in alike), default=0)
        if abs(one.updates - other.updates) > slack:
            found.append(f"motion {at + 1} ({one.kind}): {other.updates} updates, not {one.updates}")
        most_m, most_rad = max(one.most_m, other.most_m), max(one.most_rad, other.most_rad)
        if abs(one.length_m - other.length_m) > slack * most_m + _ROUNDING:
            found.append(f"motion {at + 1} ({one.kind}): {other.length_m:.3f} m, not {one.length_m:.3f}")
        if abs(one.turn_rad - other.turn_rad) > slack * most_rad + _ROUNDING:
            found.append(f"motion {at + 1} ({one.kind}): {other.turn_rad:.3f} rad, not {one.turn_rad:.3f}")
        slack_m += slack * most_m + slack_rad * abs(one.length_m)
        slack_rad += slack * most_rad
    slack_m += max((math.dist(twin.end[:2], real.end[:2]) for twin in twins), default=0.0)
    if math.dist(ours.end[:2], real.end[:2]) > slack_m:
        found.append(f"ends at {ours.end}, not {real.end}")
    took_s, wanted_s = ours.ended_s - ours.began_s, real.ended_s - real.began_s
    slack_s = _SLOW_SHARE * wanted_s + UPDATE_S * SLACK_UPDATES
    slack_s += max((abs(twin.ended_s - twin.began_s - wanted_s) for twin in twins), default=0.0)
    if abs(took_s - wanted_s) > slack_s:
        found.append(f"{took_s:.2f} s from the first motion to the last, not {wanted_s:.2f}")
    if ours.jumps != real.jumps and all(ours.jumps != twin.jumps for twin in twins):
        found.append(f"{ours.jumps} jumps, not {real.jumps}")
    return found


def _kinds(motions: Sequence[Motion]) -> list[str]:
    return [each.kind for each in motions]


def _merged(motions: Sequence[Motion]) -> list[Motion]:
    """Leave out the briefest motions; what they parted is one again."""
    merged: list[Motion] = []
    for each in motions:
        if each.updates <= _BRIEF:
            continue
        if merged and merged[-1].kind == each.kind:
            one = merged.pop()
            sums = (a + b for a, b in zip(one[1:4], each[1:4], strict=True))
            most = (max(one.most_m, each.most_m), max(one.most_rad, each.most_rad))
            merged.append(Motion(each.kind, *sums, *most))
        else:
            merged.append(each)
    return merged


def drive(grader: Grader, recording: Recording, real: Driven) -> Driven:
    """Run a recording's script; Ctrl+C comes as long after its first motion as it did on the real thing.

    The real process took a second to start; ours begins with the script.
    """
    stop_s = recording.interrupted_at_s
    if stop_s is None:
        return of_ours(run(grader, recording, 120.0))
    ours = of_ours(run(grader, recording, max(stop_s - _START_S, 0.5)))
    late_s = real.began_s - ours.began_s
    if math.isnan(late_s) or abs(late_s - _START_S) < 0.008:
        return ours
    return of_ours(run(grader, recording, max(stop_s - late_s, 0.5)))


EXPLAINED: Final = {
    "style__clear_screen_menu": "asks for the terminal's size; the recorded process had no terminal, ours has one",
    "style__point_cloud_obstacle": "imports sensor_msgs, which the recording machine did not have",
    "style__tf2_follow_own_frame": "imports tf2_ros, which the recording machine did not have",
    "style__timer_elapsed": "`elapsed >= T` in a periodic tick often holds a period later at home, never here",
    "t03_hold": "publishes linear.y: turtlesim 1.4 slides sideways, a car on two wheels cannot",
    "t12_model": "its commands follow the machine's clock; test_the_law compares them one by one",
}
"""What of ours differs from its recordings, and why."""
