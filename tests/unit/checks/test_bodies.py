"""Check ``bodies``: each measure in a replayed world whose measure is known, and what ends the counting."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from grader.checks import problems, sketch
from grader.checks.kinds.bodies import explain, measure
from grader.contracts.assignment import Assignment, ItemSpec, Watch, World
from grader.contracts.outcome import RunStatus
from grader.contracts.replay import Replayed, ReplayedBody, Trick
from grader.contracts.scoring import Run
from grader.contracts.text import Text
from grader.sim.replay import planar
from tests.unit.checks.trajectories import run_of
from tests.unit.sim.replays import EVERY_NS, replayed

NAME = Text(zh="x", en="x")
TARGET = {"target_x_m": 1.0, "target_y_m": 0.0, "target_z_m": 0.5}
FALL = [(0.0, 0.0, max(0.5, 2.0 - 0.05 * i)) for i in range(91)]
DRIVE = [(0.01 * min(i, 200), 0.0, 0.1) for i in range(261)]
APPROACH = [(0.01 * min(i, 100), 0.0, 0.5) for i in range(161)]


def task(*measures: str, watch: Watch | None = None, **options: Any) -> Assignment:
    items = tuple(ItemSpec(id=each, title=NAME, points=1.0, measure=each, low=0.1) for each in measures)
    watch = watch or Watch(object="sphere2.urdf", robot="panda.urdf", link=11)
    return Assignment(
        id="a", version=1, order=1, title=NAME, brief=NAME, check="bodies", items=items, options=options,
        world=World(kind="pybullet", watch=watch),
    )  # fmt: skip


def run(world: Replayed | None) -> Run:
    made = run_of(planar(world or replayed()))
    return replace(made, replayed=world, outcome=replace(made.outcome, status=RunStatus.FINISHED))


def values(world: Replayed, assignment: Assignment | None = None) -> dict[str, float]:
    found = measure(assignment or task(), run(world))
    return {name: measure.value for name, measure in found.items()}


def mistakes(world: Replayed | None, assignment: Assignment | None = None) -> list[str]:
    asked, happened = assignment or task(), run(world)
    return [one.code for one in explain(asked, happened, measure(asked, happened))]


def trick(at: int, kind: str = "jump", *, before_start: bool = False) -> tuple[Trick, ...]:
    t_ns, call = at * EVERY_NS, 4 * at + 1
    return (Trick(kind=kind, name="call", call=call, t_ns=t_ns, before_start=before_start),)  # type: ignore[arg-type]


def test_a_fall_and_a_rest() -> None:
    seen = values(replayed(FALL))
    assert seen["start_m"] == pytest.approx(2.0)
    assert seen["fell_m"] == pytest.approx(1.5)
    assert seen["height_m"] == pytest.approx(0.5)
    assert seen["rest_s"] == pytest.approx((90 - 31) / 60.0, abs=0.03)
    assert seen["simulated_s"] == pytest.approx(1.5, abs=1e-6)
    assert seen["gravity"] == 1.0


def test_a_drive_its_turn_and_its_wheels() -> None:
    joints = np.linspace(0.0, 3.0 * math.tau, len(DRIVE))[:, None]
    seen = values(replayed(DRIVE, object_joints=joints))
    assert seen["travel_m"] == pytest.approx(2.0)
    assert seen["turned_deg"] == pytest.approx(0.0)
    assert seen["wheels_turned"] == pytest.approx(3.0)


def test_wheels_that_no_motor_turned_do_not_count() -> None:
    car = (ReplayedBody(id=1, role="object", joints=2, mass_kg=1.0, total_kg=4.0),)
    wheels = np.linspace(0.0, 3.0 * math.tau, len(DRIVE))[:, None]
    rubric = task("wheels_turned", watch=Watch(object="*"))
    for watts, turns in ((1.0, 3.0), (0.01, math.nan)):  # 4 kg at 0.6 m/s is 0.72 J
        drive = replayed(DRIVE, object_joints=wheels, power_w=np.full(len(DRIVE), watts), bodies=car)
        assert values(drive, rubric)["wheels_turned"] == pytest.approx(turns, nan_ok=True)
        assert ("bodies_rolled" in mistakes(drive, rubric)) == math.isnan(turns)
    jacked = [DRIVE[0]] * 60 + list(DRIVE)  # turned on a jack, then down a slope
    watts = np.array([9.0] * 60 + [0.01] * len(DRIVE))
    rolled = replayed(jacked, object_joints=np.tile(wheels, (2, 1))[: len(jacked)], power_w=watts, bodies=car)
    assert math.isnan(values(rolled, rubric)["wheels_turned"])


@pytest.mark.parametrize(
    ("gravity", "fits"), [((0, 0, -9.8), 1), ((0, 0, -10), 1), ((0, 0, -9.5), 0), ((0, -9.8, 0), 0)]
)
def test_gravity_is_the_earths_downwards(gravity: tuple[float, ...], fits: float) -> None:
    assert values(replayed(FALL, gravity=tuple(map(float, gravity))))["gravity"] == fits


def test_a_target_is_reached_only_if_it_is_kept_and_was_not_the_start() -> None:
    aim = task("reach_m", **TARGET)
    assert values(replayed(links=APPROACH), aim)["reach_m"] == pytest.approx(0.0)
    through = [(0.02 * i, 0.0, 0.5) for i in range(121)]
    assert values(replayed(links=through), aim)["reach_m"] == pytest.approx(0.3, abs=0.02)
    assert "reach_m" not in values(replayed(links=APPROACH[100:]), aim)
    assert "bodies_there_already" in mistakes(replayed(links=APPROACH[100:]), aim)
    assert "reach_m" not in values(replayed(links=APPROACH[:20]), aim)  # shorter than it must be kept
    partly = measure(aim, run(replayed(links=APPROACH[:40] * 2)))["reach_m"]  # not half of the way
    assert 0.0 < partly.share < 1.0


def test_an_arm_reaches_by_itself_from_its_place() -> None:
    aim = task("reach_m", **TARGET)
    aside = replayed(links=APPROACH, base=np.full((len(APPROACH), 3), 0.1))
    assert "reach_m" not in values(aside, aim)
    assert "bodies_base_elsewhere" in mistakes(aside, aim)
    assert (
        values(aside, task("reach_m", **TARGET, base_x_m=0.1, base_y_m=0.1, base_z_m=0.1))["reach_m"] == 0.0
    )
    loose = (ReplayedBody(id=2, role="robot", mass_kg=1.0),)
    assert "reach_m" not in values(replayed(links=APPROACH, bodies=loose), aim)
    arm, box = ReplayedBody(id=2, role="robot"), ReplayedBody(id=3)
    pushed = (((3, -1, 9.0),),) * len(APPROACH)
    on_the_way = (*pushed[:20], *((),) * (len(APPROACH) - 20))  # past a table
    assert "reach_m" in values(replayed(links=APPROACH, bodies=(arm, box), pushes=on_the_way), aim)
    assert "reach_m" not in values(replayed(links=APPROACH, bodies=(arm, box), pushes=pushed), aim)  # held up
    for stranger in (replace(box, mass_kg=1.0), replace(box, is_late=True)):
        world = replayed(links=APPROACH, bodies=(arm, stranger), pushes=pushed)
        assert "reach_m" not in values(world, aim)
        assert "bodies_pushed" in mistakes(world, aim)


def test_an_object_is_lifted_while_two_fingers_hold_it() -> None:
    rise = [(0.0, 0.0, 0.02 + 0.005 * max(0, min(i - 30, 40))) for i in range(161)]
    ground, fingers, one = (0, -1, 1.0), ((2, 9, 5.0), (2, 10, 5.0)), ((2, 9, 5.0),)
    hands = [(0.0, 0.0, 0.5)] * 161

    def lifted(*pushes: tuple[tuple[int, int, float], ...]) -> float:
        return values(replayed(rise, hands, pushes=pushes))["lifted_m"]

    lying = (*((ground,),) * 20, *((ground, *fingers),) * 11)
    assert lifted(*lying, *(fingers,) * 130) == pytest.approx(0.2)
    assert math.isnan(lifted(*((ground, *one),) * 31, *(one,) * 130))
    assert math.isnan(lifted(*(fingers,) * 161))  # put between the fingers
    assert lifted(*lying, *((ground, *fingers),) * 130) == 0.0  # raised by what lies below it
    assert lifted(*lying, *(fingers,) * 20, *((),) * 110) == 0.0  # let go
    by_one = replayed(rise, hands, pushes=((ground, *one),) * 161)
    assert "bodies_not_held" in mistakes(by_one, task("lifted_m"))


def test_what_follows_a_trick_does_not_count() -> None:
    seen = values(replayed(FALL, tricks=trick(10)))
    assert seen["simulated_s"] == pytest.approx(10 / 60.0, abs=1e-6)
    assert seen["fell_m"] == pytest.approx(0.5)
    assert "bodies_by_hand" in mistakes(replayed(FALL, tricks=trick(10)))
    assert values(replayed(FALL, tricks=trick(0, before_start=True)))["simulated_s"] == 0.0
    allowed = task(allow="jump push")
    assert values(replayed(FALL, tricks=trick(10)), allowed)["fell_m"] == pytest.approx(1.5)
    assert "bodies_by_hand" not in mistakes(replayed(FALL, tricks=trick(10)), allowed)


def test_what_is_missing_is_told() -> None:
    assert "bodies_not_loaded" in mistakes(replayed(FALL, bodies=()))
    assert "bodies_no_car" in mistakes(replayed(FALL, bodies=()), task(watch=Watch(object="*")))
    assert "bodies_no_steps" in mistakes(replayed(FALL, steps=0))
    assert "bodies_weightless" in mistakes(replayed(FALL, gravity=(0.0, 0.0, 0.0)))
    assert "bodies_void" in mistakes(replayed([(0.0, 0.0, -3.0)] * 2))
    assert "bodies_too_many" in mistakes(replayed(FALL, end="too_many_bodies"))
    assert "bodies_not_finite" in mistakes(replayed(FALL, end="not_finite"))
    loose = (ReplayedBody(id=2, role="robot", mass_kg=1.0),)
    assert "bodies_loose_base" in mistakes(replayed(FALL, bodies=loose))
    assert values(replayed([]))["simulated_s"] == 0.0


def test_it_is_drawn_by_pictures() -> None:
    assert sketch(task("loaded"), run(replayed(FALL))).view == "frames"


@pytest.mark.parametrize(
    ("assignment", "field"),
    [
        (task("reach_m"), "items.0.measure"),
        (task("lifted_m", watch=Watch(object="cube.urdf")), "items.0.measure"),
        (task("fell_m", watch=Watch(robot="panda.urdf")), "items.0.measure"),
        (task("loaded", hold_s=0), "options.hold_s"),
        (task("loaded", allow="magic"), "options.allow"),
        (task("loaded", target_x_m="far"), "options.target_x_m"),
    ],
)
def test_what_does_not_fit_names_its_field(assignment: Assignment, field: str) -> None:
    assert field in [name for name, _ in problems(assignment)]
