"""The nominal car against an exact model of turtlesim 1.4: same commands, same published poses."""

import itertools
import math
import random
from collections.abc import Callable
from dataclasses import dataclass

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from grader.contracts.assignment import WINDOW_M, StartPose, World
from grader.contracts.trajectory import Trajectory
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from tests.examples import examples
from tests.fakes import jail, turtlesim
from tests.fakes.jail import SECOND, FakeLink, Script
from tests.fakes.turtlesim import Pose

MS = 1_000_000
UPDATE_US = 16_000
METRES = 1e-3
RADIANS = math.radians(0.02)
SHARE = 1e-6
HORIZON_NS = 60 * SECOND
CENTRE = WINDOW_M / 2.0

Commands = list[tuple[int, float, float]]
Controller = Callable[[int, Pose | None], tuple[float, float] | None]
"""Called with the time and the last pose; returns what to publish, if anything."""


@dataclass
class Driven:
    """What a script published and heard."""

    commands: Commands
    heard: list[Pose]
    result: EpisodeResult


def drive(
    car: Car,
    decide: Controller,
    *,
    period_ns: int,
    reaction_ns: int = 3_000,
    heading_deg: float = 0.0,
    walls: bool = True,
    horizon_ns: int = HORIZON_NS,
) -> Driven:
    """Run a script that is called with each pose, and every `period_ns`, and hears /turtle1/pose throughout."""
    commands: Commands = []
    heard: list[Pose] = []

    def script() -> Script:
        yield jail.node()
        yield jail.driver()
        yield jail.entity(3, 3, name="/turtle1/pose", type="turtlesim/msg/Pose")
        now = 0
        while now < horizon_ns:
            wake = min((now // period_ns + 1) * period_ns, horizon_ns)
            answer = yield jail.advance(wake)
            assert answer is not None
            now = max(now, answer.now_ns)
            for _, _, _, t_ns, payload in answer.events:
                said = jail.decode("turtlesim/msg/Pose", payload)
                heard.append(
                    Pose(
                        t_ns,
                        said["x"],
                        said["y"],
                        said["theta"],
                        said["linear_velocity"],
                        said["angular_velocity"],
                    )
                )
            wanted = decide(now, heard[-1] if heard else None)
            if wanted is not None and now < horizon_ns:
                now += reaction_ns
                commands.append((now, *wanted))
                yield jail.publish(2, now, jail.twist(*wanted))
        yield jail.ended(now)

    world = World(walls=walls, start=StartPose(heading_deg=heading_deg))
    spec = EpisodeSpec(world=world, horizon_ns=horizon_ns, source=b"", file_name="a.py")
    result = Episode(spec, car).run(FakeLink(script()))
    assert result.violation is None
    return Driven(commands, heard, result)


def assert_as_turtlesim(driven: Driven, *, heading_deg: float, walls: bool) -> None:
    """Compare every published pose with the model's, and see that the heading rests where no turn is told."""
    start = (CENTRE, CENTRE, math.radians(heading_deg))
    wanted = turtlesim.poses(driven.commands, driven.heard[-1].t_ns, start, walls=walls)
    assert [pose.t_ns for pose in driven.heard] == [pose.t_ns for pose in wanted]
    for got, exact in zip(driven.heard, wanted, strict=True):
        assert math.hypot(got.x - exact.x, got.y - exact.y) <= METRES, got
        assert abs(math.remainder(got.theta - exact.theta, math.tau)) <= RADIANS, got
        assert abs(got.v - exact.v) <= SHARE * abs(exact.v), (
            got
        )  # pytest.approx would take a quarter of the time
        assert abs(got.w - exact.w) <= SHARE * abs(exact.w), got
    for before, after in itertools.pairwise(driven.heard):
        if after.w == 0.0:
            assert after.theta == before.theta
        if after.v == 0.0:
            assert (after.x, after.y) == (before.x, before.y)


SPEEDS = st.one_of(st.just(0.0), st.floats(0.1, 3.0), st.floats(-3.0, -0.1))
RATES = st.one_of(st.just(0.0), st.floats(0.1, math.tau), st.floats(-math.tau, -0.1))
LEG = st.tuples(st.integers(1, 4_000), SPEEDS, RATES)  # milliseconds, m/s, rad/s


@settings(max_examples=examples(8))
@given(
    legs=st.lists(LEG, min_size=1, max_size=20),
    period_ms=st.integers(5, 1_300),
    reaction_ns=st.integers(0, 15 * MS),
    heading_deg=st.floats(-180.0, 180.0),
    walls=st.booleans(),
)
def test_open_loops_go_where_turtlesim_goes(
    car: Car,
    legs: list[tuple[int, float, float]],
    period_ms: int,
    reaction_ns: int,
    heading_deg: float,
    walls: bool,
) -> None:
    edges = list(itertools.accumulate(leg[0] for leg in legs))
    spoken_ns = -period_ms * MS

    def decide(now_ns: int, _: Pose | None) -> tuple[float, float] | None:
        nonlocal spoken_ns
        leg = next((leg for leg, edge in zip(legs, edges, strict=True) if now_ns < edge * MS), None)
        if leg is None or now_ns < spoken_ns + period_ms * MS:
            return None
        spoken_ns = now_ns
        return leg[1:]

    driven = drive(
        car, decide, period_ns=period_ms * MS, reaction_ns=reaction_ns, heading_deg=heading_deg, walls=walls
    )
    assert_as_turtlesim(driven, heading_deg=heading_deg, walls=walls)


FAST_LEG = st.tuples(st.integers(1, 150), SPEEDS, RATES)  # messages, m/s, rad/s


@settings(max_examples=examples(8))
@given(
    legs=st.lists(FAST_LEG, min_size=1, max_size=8),
    period_us=st.integers(500, 30_000),
    pause_ms=st.integers(0, 300),
    walls=st.booleans(),
)
@example(legs=[(200, 1.0, 0.0), (157, 0.0, 1.0)], period_us=10_000, pause_ms=100, walls=True)
def test_beside_what_was_driven_stands_what_was_commanded(
    car: Car, legs: list[tuple[int, float, float]], period_us: int, pause_ms: int, walls: bool
) -> None:
    commands: Commands = []
    now = 500
    for count, v, w in legs:
        for _ in range(count):
            commands.append((now, v, w))
            now += period_us * 1_000
        commands.append((now, 0.0, 0.0))
        now += pause_ms * MS
    frames = [jail.node(), jail.driver(), *(jail.publish(2, t, jail.twist(v, w)) for t, v, w in commands)]
    spec = EpisodeSpec(world=World(walls=walls), horizon_ns=60 * SECOND, source=b"", file_name="a.py")
    result = Episode(spec, car).run(FakeLink([*frames, jail.ended(now)]))
    start, end_ns = (CENTRE, CENTRE, 0.0), result.trajectory.end_ns
    driven = turtlesim.poses(commands, end_ns, start, walls=walls)
    assert_at(result.trajectory, driven)
    waited = [note.text for note in result.notes if note.code == "commands_wait"]
    at_once = turtlesim.poses(commands, end_ns, start, walls=walls, kept=1)
    if result.trajectory.commanded is not None:
        assert_at(result.trajectory.commanded, at_once)
    assert all(0.04 < float(text.split("|")[1]) <= 0.12 for text in waited)
    if period_us > UPDATE_US and pause_ms > UPDATE_US // 1_000:
        assert result.trajectory.commanded is None


def assert_at(path: Trajectory, poses: list[Pose]) -> None:
    """See that a recorded motion has the model's poses at its samples."""
    wanted = {pose.t_ns: pose for pose in poses}
    for t_ns, x, y in zip(path.t_ns.tolist(), path.x_m, path.y_m, strict=True):
        if t_ns:
            assert math.hypot(x - wanted[t_ns].x, y - wanted[t_ns].y) < 1e-9


@settings(max_examples=examples(5))
@given(
    v=st.floats(0.1, 3.0),
    w=st.floats(0.1, math.tau),
    corner_deg=st.floats(30.0, 170.0),
    side_m=st.floats(0.2, 3.0),
    reaction_ns=st.integers(0, 5 * MS),
    heading_deg=st.floats(-180.0, 180.0),
)
def test_closed_loops_turn_as_far_as_on_turtlesim(
    car: Car,
    v: float,
    w: float,
    corner_deg: float,
    side_m: float,
    reaction_ns: int,
    heading_deg: float,
) -> None:
    turned = driven_m = 0.0
    last: Pose | None = None
    turning = False

    def decide(_: int, pose: Pose | None) -> tuple[float, float] | None:
        """Drive a side, turn a corner, judged in the pose callback alone."""
        nonlocal turned, driven_m, last, turning
        if pose is None or pose == last:
            return None
        if last is not None:
            turned += math.remainder(pose.theta - last.theta, math.tau)
            driven_m += math.hypot(pose.x - last.x, pose.y - last.y)
        last = pose
        if turning and turned >= math.radians(corner_deg):
            turning, turned, driven_m = False, 0.0, 0.0
        elif not turning and driven_m >= side_m:
            turning, turned, driven_m = True, 0.0, 0.0
        return (0.0, w) if turning else (v, 0.0)

    driven = drive(
        car,
        decide,
        period_ns=HORIZON_NS,
        reaction_ns=reaction_ns,
        heading_deg=heading_deg,
        walls=False,
    )
    assert_as_turtlesim(driven, heading_deg=heading_deg, walls=False)


@pytest.mark.parametrize(("w", "corner_deg"), [(2.0, 91.7), (3.0, 90.8)])
def test_a_corner_that_ends_in_the_pose_callback_is_turtlesims(car: Car, w: float, corner_deg: float) -> None:
    def decide(_: int, pose: Pose | None) -> tuple[float, float] | None:
        return (0.0, w if pose is None or 0.0 <= pose.theta < math.pi / 2 else 0.0)

    driven = drive(car, decide, period_ns=HORIZON_NS, horizon_ns=3 * SECOND)
    assert math.degrees(driven.heard[-1].theta) == pytest.approx(corner_deg, abs=0.05)


@pytest.mark.parametrize("heading_deg", [0.0, 37.0, 84.0, -135.0])
def test_the_heading_keeps_its_bits_through_accelerations_and_walls(car: Car, heading_deg: float) -> None:
    chance = random.Random(heading_deg)

    def decide(now_ns: int, _: Pose | None) -> tuple[float, float] | None:
        return (chance.choice([0.0, 0.3, -1.0, 3.0, 8.0, -8.0]), 0.0) if now_ns % (250 * MS) == 0 else None

    driven = drive(car, decide, period_ns=250 * MS, heading_deg=heading_deg, horizon_ns=20 * SECOND)
    assert len({pose.theta for pose in driven.heard}) == 1
    path = driven.result.trajectory
    assert path.contacts
    assert set(path.heading_rad) == {math.radians(heading_deg)}
    assert not path.w_radps.any()


def test_across_the_direction_of_travel_nothing_moves(car: Car) -> None:
    driven = drive(
        car, lambda now_ns, _: (math.sin(now_ns / 1e9), 0.0), period_ns=50 * MS, horizon_ns=20 * SECOND
    )
    assert len({pose.y for pose in driven.heard}) == 1
    assert len(set(driven.result.trajectory.y_m)) == 1


def test_a_single_command_drives_63_updates(car: Car) -> None:
    driven = drive(
        car,
        lambda now_ns, _: (1.0, 0.0) if now_ns == 96 * MS else None,
        period_ns=HORIZON_NS,
        horizon_ns=3 * SECOND,
    )
    assert driven.heard[-1].x == pytest.approx(CENTRE + 63 * 0.016, abs=1e-6)
    assert sum(pose.v == 1.0 for pose in driven.heard) == 63


def test_what_is_recorded_is_what_was_published(car: Car) -> None:
    driven = drive(
        car,
        lambda now_ns, _: (1.0, 0.5 if now_ns > SECOND else 0.0),
        period_ns=100 * MS,
        horizon_ns=4 * SECOND,
    )
    path = driven.result.trajectory
    recorded = dict(zip(path.t_ns.tolist(), zip(path.x_m, path.y_m, strict=True), strict=True))
    for pose in driven.heard:
        assert recorded[pose.t_ns] == pytest.approx((pose.x, pose.y), abs=1e-6)  # the message has 32 bits
