"""Mistakes in a PyBullet world, recognised from its replay."""

import math
from collections.abc import Iterator

from grader.checks.measure import Measures, Mistake, mistake
from grader.checks.mistakes import noted, script_mistakes
from grader.contracts.assignment import Assignment
from grader.contracts.replay import Replayed, Trick
from grader.contracts.scoring import Run
from grader.geometry import exact
from grader.messages.quantity import number

STARTS_AWAY_M = 0.15
"""A link that starts nearer to its target than this has been put there and did not move there."""

BASE_SLACK_M = 0.02
"""How far from its place an arm's base may stand."""

_VOID_M = -1.0  # an object this far below the ground has fallen past it and falls for ever
_OF_FALLEN = ("height_m", "travel_m", "rest_s", "turned_deg", "lifted_m")
_OF_UNLOADED = (
    "loaded",
    "fell_m",
    "height_m",
    "rest_s",
    "travel_m",
    "turned_deg",
    "wheels_turned",
    "reach_m",
    "lifted_m",
)


def bodies_mistakes(
    assignment: Assignment,
    run: Run,
    replayed: Replayed | None,
    trick: Trick | None,
    measures: Measures,
) -> tuple[Mistake, ...]:
    """Return what probably went wrong; `trick` is the call after which nothing counted."""
    found = [*script_mistakes(run)]
    if replayed is not None and replayed.calls:  # what makes others follow comes first: see `first_causes`
        found += _ended(replayed)
        found += _by_hand(trick)
        found += _absent(assignment, replayed)
        found += _still(run, replayed)
        found += _loose(replayed)
        found += _fallen(replayed)
        found += _there_already(assignment, replayed)
        found += _not_reached(assignment, replayed)
        found += _rolled(assignment, replayed, measures)
        found += _unheld(assignment, measures)
    return tuple(found)


def _ended(replayed: Replayed) -> Iterator[Mistake]:
    """Say why the replay ended before its last call."""
    if replayed.end == "too_many_bodies":
        yield mistake("bodies_too_many")
    elif replayed.end == "not_finite":
        yield mistake("bodies_not_finite")


def _by_hand(trick: Trick | None) -> Iterator[Mistake]:
    if trick is not None and not trick.name:
        yield mistake("bodies_pushed", time=number(trick.t_ns / 1e9, "s"))
    elif trick is not None:
        yield mistake("bodies_by_hand", call=trick.name, time=number(trick.t_ns / 1e9, "s"))


def _absent(assignment: Assignment, replayed: Replayed) -> Iterator[Mistake]:
    """Recognise a body that the assignment measures and the script did not load."""
    watch, roles = assignment.world.watch, {body.role for body in replayed.bodies}
    for role in ("object", "robot"):
        wanted = getattr(watch, role)
        if wanted and role not in roles:
            files = ", ".join(dict.fromkeys(body.file for body in replayed.bodies if body.file)) or "-"
            code = "bodies_no_car" if wanted == "*" else "bodies_not_loaded"
            yield mistake(code, _OF_UNLOADED, file=wanted, files=files)


def _still(run: Run, replayed: Replayed) -> Iterator[Mistake]:
    """Recognise a world without steps or gravity, and one whose recording was cut off."""
    if replayed.steps == 0:
        yield mistake("bodies_no_steps")
    elif replayed.gravity == (0.0, 0.0, 0.0):
        yield mistake("bodies_weightless", ("gravity", "fell_m", "height_m", "travel_m", "wheels_turned"))
    if (cut := noted(run.outcome, "bullet_too_many")) is not None:
        yield mistake("bodies_too_many_calls", ("simulated_s", "rest_s"), calls=cut)


def _loose(replayed: Replayed) -> Iterator[Mistake]:
    """Recognise an arm whose base is not fixed."""
    if any(body.role == "robot" and body.mass_kg > 0.0 for body in replayed.bodies):
        yield mistake("bodies_loose_base", ("reach_m", "lifted_m"))


def _fallen(replayed: Replayed) -> Iterator[Mistake]:
    heights = replayed.object[:, 2]
    if len(heights) and heights[-1] < _VOID_M:
        yield mistake("bodies_void", _OF_FALLEN)


def _there_already(assignment: Assignment, replayed: Replayed) -> Iterator[Mistake]:
    """Recognise a link that was put at its target before the first step."""
    target = [assignment.options.get(f"target_{axis}_m") for axis in "xyz"]
    if None not in target and len(replayed.link):
        place = [float(coordinate) for coordinate in replayed.link[0, :3]]
        if exact.apart(place, [float(coordinate or 0.0) for coordinate in target]) < STARTS_AWAY_M:
            yield mistake("bodies_there_already", ("reach_m",))


def _not_reached(assignment: Assignment, replayed: Replayed) -> Iterator[Mistake]:
    """Recognise an arm that stands elsewhere."""
    target = [assignment.options.get(f"target_{axis}_m") for axis in "xyz"]
    if None not in target and len(replayed.base):
        place = [float(assignment.options.get(f"base_{axis}_m") or 0.0) for axis in "xyz"]
        base = [float(coordinate) for coordinate in replayed.base[0]]
        if exact.apart(base, place) > BASE_SLACK_M:
            told = {"base": _point(base), "place": _point(place)}
            yield mistake("bodies_base_elsewhere", ("reach_m",), **told)


def _point(place: list[float]) -> str:
    return f"({', '.join(f'{each:.3g}' for each in place)})"


def _rolled(assignment: Assignment, replayed: Replayed, measures: Measures) -> Iterator[Mistake]:
    """Recognise a car that moved without its motors: down a slope, or pushed."""
    turned = measures.get("wheels_turned")
    if assignment.item_on("wheels_turned") and turned is not None and math.isnan(turned.value):
        yield mistake("bodies_rolled", ("wheels_turned", "travel_m"))


def _unheld(assignment: Assignment, measures: Measures) -> Iterator[Mistake]:
    lifted = measures.get("lifted_m")
    if assignment.item_on("lifted_m") and lifted is not None and math.isnan(lifted.value):
        yield mistake("bodies_not_held", ("lifted_m",))
