"""Drivers that look at nothing that an exercise is about: what they earn, nobody has to look for.

They stand for students who hope for points without sensors: figures, wandering between random points, and the
solution's own commands, played where it did not give them. `grader assignments validate` has each of them graded
on every exercise with a sensor or a goal.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import chain
from typing import Final, NamedTuple

from grader.contracts.assignment import WINDOW_M, Assignment
from grader.contracts.grading import Grader, GradingJob, GradingResult
from grader.contracts.text import EMPTY, Text
from grader.contracts.trajectory import Command, decode_trajectory
from grader.grading.examination import Finding, OwnScript

MOST_PCT: Final = 40.0
"""Of an exercise's points, that a blind driver may earn: for moving, touching nothing, coming to rest."""

_PAID: Final = Text(zh="不看传感器也得了这么多分", en="earns too much without looking")
_CHECKS: Final = ("room", "places")
_PERIOD_S: Final = 0.1
_PLAYER: Final = """import time
import rclpy
from geometry_msgs.msg import Twist
COMMANDS = {commands}
rclpy.init()
node = rclpy.create_node("blind")
publisher = node.create_publisher(Twist, "{topic}", 10)
begin = time.time()
try:
    for at, speed, turn in COMMANDS:
        time.sleep(max(begin + at - time.time(), 0.0))
        message = Twist()
        message.linear.x, message.angular.z = speed, turn
        publisher.publish(message)
    time.sleep(1.0)
except KeyboardInterrupt:
    pass
"""
_WANDERER: Final = """import math, random
import rclpy
from geometry_msgs.msg import Twist
from {pose_type} import {pose_name}
rclpy.init()
node = rclpy.create_node("blind")
publisher = node.create_publisher(Twist, "{topic}", 10)
random.seed(0)
def anywhere():
    return random.uniform({left}, {right}), random.uniform({bottom}, {top})
aim = anywhere()
def on_pose(message):
    global aim
    {read}
    if math.hypot(aim[0] - x, aim[1] - y) < {near}:
        aim = anywhere()
    error = math.remainder(math.atan2(aim[1] - y, aim[0] - x) - heading, math.tau)
    command = Twist()
    command.angular.z = max(-{turn}, min({turn}, 4.0 * error))
    command.linear.x = {speed} if abs(error) < 0.5 else 0.0
    publisher.publish(command)
node.create_subscription({pose_name}, "{pose}", on_pose, 10)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
"""
_READ_POSE: Final = "x, y, heading = message.x, message.y, message.theta"
_READ_ODOMETRY: Final = (
    "place, q = message.pose.pose.position, message.pose.pose.orientation; "
    "x, y, heading = place.x, place.y, 2.0 * math.atan2(q.z, q.w)"
)


class Vehicle(NamedTuple):
    """What is driven: its usual speed and turn, and how far it is across the field."""

    topic: str
    speed_mps: float
    turn_radps: float
    field_m: float


def looks(assignment: Assignment) -> bool:
    """Return whether an exercise asks to look at something: it has a sensor or a goal."""
    return assignment.check in _CHECKS and assignment.input == "script"


def driven_blindly(
    assignment: Assignment, solution: OwnScript, grader: Grader, elsewhere: Assignment | None = None
) -> list[Finding]:
    """Grade the standing set on an exercise; a driver with more than `MOST_PCT` of the points is a problem.

    `elsewhere`: the same exercise with other seeds.

    Raises GraderError: the grader failed.
    """

    def graded(script: OwnScript, task: Assignment) -> GradingResult:
        return grader.grade(GradingJob(file_name=script.name, source=script.source, assignment=task))

    right = graded(solution, assignment)
    other = None if elsewhere is None else graded(solution, elsewhere)
    findings = []
    for driver in blind_drivers(assignment, right, other):
        report = graded(driver, assignment).report
        is_paid = (report.score or 0.0) > MOST_PCT / 100.0 * report.max_score
        findings.append(
            Finding(
                assignment=assignment.id,
                script=driver.name,
                score=report.score,
                max_score=report.max_score,
                problem=_PAID if is_paid else EMPTY,
            )
        )
    return findings


def blind_drivers(
    assignment: Assignment, solution: GradingResult, elsewhere: GradingResult | None = None
) -> list[OwnScript]:
    """Return the standing set for an exercise, whose solution was graded as `solution`.

    `elsewhere`: its solution in rooms and from starts of other seeds.
    """
    vehicle, horizon_s = _vehicle(assignment), assignment.horizon_s
    played: dict[str, tuple[Command, ...]] = {
        name: tuple(_cut(figure(vehicle, horizon_s), horizon_s)) for name, figure in _FIGURES.items()
    }
    played["first case"] = _recorded(solution)
    if elsewhere is not None:
        played["other seed"] = _recorded(elsewhere)
    drivers = [OwnScript(name=name, source=_player(vehicle, commands)) for name, commands in played.items()]
    return [*drivers, OwnScript(name="random points", source=_wanderer(assignment, vehicle))]


Step = tuple[float, float, float]
"""For how long, how fast, and turning how fast."""


def _circle(vehicle: Vehicle, _: float) -> Iterable[Step]:
    yield math.inf, vehicle.turn_radps * vehicle.field_m / 30.0, -vehicle.turn_radps


def _wide_circle(vehicle: Vehicle, _: float) -> Iterable[Step]:
    yield math.inf, vehicle.speed_mps, 4.0 * vehicle.speed_mps / vehicle.field_m


def _spiral(vehicle: Vehicle, horizon_s: float) -> Iterable[Step]:
    """From the spot to the width of the field, in the whole time."""
    for share in _shares(round(horizon_s)):
        radius_m = max(0.02, share / 2.0) * vehicle.field_m
        yield 1.0, vehicle.speed_mps, min(vehicle.turn_radps, vehicle.speed_mps / radius_m)


def _shares(count: int) -> Iterator[float]:
    return (i / count for i in range(count))


def _sweep(vehicle: Vehicle, _: float) -> Iterable[Step]:
    """Up and down in rows."""
    corner_s = math.pi / 2.0 / vehicle.turn_radps
    for side in (1.0, -1.0) * 1_000:
        yield vehicle.field_m / 2.0 / vehicle.speed_mps, vehicle.speed_mps, 0.0
        yield corner_s, 0.0, side * vehicle.turn_radps
        yield vehicle.field_m / 10.0 / vehicle.speed_mps, vehicle.speed_mps, 0.0
        yield corner_s, 0.0, side * vehicle.turn_radps


def _bumper(vehicle: Vehicle, _: float) -> Iterable[Step]:
    """Ahead until there must have been a wall, back a little, and on in another direction."""
    for _ in range(1_000):
        yield vehicle.field_m / vehicle.speed_mps, vehicle.speed_mps, 0.0
        yield vehicle.field_m / 20.0 / vehicle.speed_mps, -vehicle.speed_mps, 0.0
        yield math.radians(100.0) / vehicle.turn_radps, 0.0, vehicle.turn_radps


def _bolt(vehicle: Vehicle, _: float, share: float = 0.25) -> Iterable[Step]:
    """Ahead for a share of the field, then rest."""
    yield share * vehicle.field_m / vehicle.speed_mps, vehicle.speed_mps, 0.0
    yield math.inf, 0.0, 0.0


_FIGURES: Final[Mapping[str, Callable[[Vehicle, float], Iterable[Step]]]] = {
    "circle": _circle,
    "wide circle": _wide_circle,
    "spiral": _spiral,
    "sweep": _sweep,
    "bumper": _bumper,
    "bolt": _bolt,
    "long bolt": partial(_bolt, share=0.5),
}


def _vehicle(assignment: Assignment) -> Vehicle:
    room = assignment.world.room
    if room is None:
        return Vehicle("/turtle1/cmd_vel", 2.0, 1.5, WINDOW_M)
    return Vehicle("/cmd_vel", 0.15, 1.0, min(room.right_m - room.left_m, room.top_m - room.bottom_m))


def _cut(steps: Iterable[Step], horizon_s: float) -> Iterator[Command]:
    """Yield the commands of a figure, ten a second, up to the horizon."""
    t_s = 0.0
    for lasts_s, speed_mps, turn_radps in chain(steps, [(math.inf, 0.0, 0.0)]):
        until_s = min(t_s + lasts_s, horizon_s)
        while t_s < until_s:
            yield Command(round(t_s * 1e9), speed_mps, turn_radps)
            t_s = min(t_s + _PERIOD_S, until_s)
        if until_s >= horizon_s:
            return


def _recorded(graded: GradingResult) -> tuple[Command, ...]:
    """Return what a solution sent in its first case."""
    return decode_trajectory(graded.trajectories[graded.report.runs[0].case]).commands


def _player(vehicle: Vehicle, commands: Iterable[Command]) -> bytes:
    rows = [(round(t_ns * 1e-9, 4), round(v, 4), round(w, 4)) for t_ns, v, w in commands]
    return _PLAYER.format(commands=rows, topic=vehicle.topic).encode()


def _wanderer(assignment: Assignment, vehicle: Vehicle) -> bytes:
    room = assignment.world.room
    left, bottom, right, top = (
        (0.0, 0.0, WINDOW_M, WINDOW_M)
        if room is None
        else (room.left_m, room.bottom_m, room.right_m, room.top_m)
    )
    inside = vehicle.field_m / 10.0
    pose_type, pose_name, pose, read = (
        ("turtlesim.msg", "Pose", "/turtle1/pose", _READ_POSE)
        if room is None
        else ("nav_msgs.msg", "Odometry", "/odom", _READ_ODOMETRY)
    )
    return _WANDERER.format(
        pose_type=pose_type,
        pose_name=pose_name,
        pose=pose,
        read=read,
        topic=vehicle.topic,
        left=left + inside,
        right=right - inside,
        bottom=bottom + inside,
        top=top - inside,
        near=vehicle.field_m / 40.0,
        turn=vehicle.turn_radps,
        speed=vehicle.speed_mps,
    ).encode()
