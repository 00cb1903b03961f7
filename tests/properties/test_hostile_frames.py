"""Whatever a jailed process sends, in whatever order: an episode ends with a bounded, repeatable result."""

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.contracts.assignment import WINDOW_M, World
from grader.sim.cdr import encode
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from tests.examples import examples
from tests.fakes import jail
from tests.fakes.jail import SECOND, FakeLink

HORIZON_NS = SECOND // 2


@pytest.fixture(scope="module")
def car() -> Iterator[Car]:
    car = Car()
    yield car
    car.close()


IDS = st.integers(1, 6)
TIMES = st.integers(0, SECOND)
FLOATS = st.floats(width=64)
NAMES = st.sampled_from(
    ["/turtle1/cmd_vel", "/turtle1/pose", "/odom", "/rosout", "/spawn", "/turtle1/teleport_absolute", "/x"]
)
TYPES = st.sampled_from(
    [
        jail.TWIST,
        "turtlesim/msg/Pose",
        "nav_msgs/msg/Odometry",
        "rcl_interfaces/msg/Log",
        "turtlesim/srv/Spawn",
    ]
)
TELEPORT = "turtlesim/srv/TeleportAbsolute"
SHIFT = "turtlesim/srv/TeleportRelative"
GOAL = "turtlesim/action/RotateAbsolute_SendGoal"
FLOATS32 = st.floats(width=32)
PAYLOADS = st.one_of(
    st.binary(max_size=30),
    st.builds(jail.twist, FLOATS, FLOATS, FLOATS),
    st.builds(lambda x, y: encode(f"{TELEPORT}_Request", {"x": x, "y": y}), FLOATS32, FLOATS32),
)
FRAMES = st.one_of(
    st.builds(
        lambda i, what, t, name, kind: jail.entity(i, what, t, name=name, type=kind),
        IDS,
        st.integers(1, 5),
        TIMES,
        NAMES,
        TYPES,
    ),
    st.builds(jail.gone, IDS, TIMES),
    st.builds(jail.publish, IDS, TIMES, PAYLOADS),
    st.builds(jail.request, IDS, st.integers(0, 3), TIMES, PAYLOADS),
    st.builds(jail.response, IDS, st.integers(0, 3), TIMES, PAYLOADS),
    st.builds(jail.advance, st.one_of(TIMES, st.integers(0, 2**63 - 1))),
    st.builds(jail.note, st.text(max_size=3), st.text(max_size=5)),
    st.builds(jail.ended, TIMES),
    st.binary(max_size=12),
)
# Times in order and ids declared get further into the episode than chance would.
OPENING = [
    jail.node(1),
    jail.driver(2),
    jail.entity(3, 3, name="/turtle1/pose", type="turtlesim/msg/Pose"),
    jail.entity(4, 5, name="/turtle1/teleport_absolute", type=TELEPORT),
    jail.entity(5, 5, name="/turtle1/teleport_relative", type=SHIFT),
    jail.entity(6, 5, name="/turtle1/rotate_absolute/_action/send_goal", type=GOAL),
]


def timed(identity: int, payloads: st.SearchStrategy[bytes]) -> st.SearchStrategy[tuple[int, bytes]]:
    make = (
        jail.publish if identity == 2 else lambda identity, t, payload: jail.request(identity, 1, t, payload)
    )
    return st.builds(lambda t, payload: (t, make(identity, t, payload)), TIMES, payloads)


def service(type: str, *fields: str) -> st.SearchStrategy[bytes]:
    return st.builds(
        lambda values: encode(f"{type}_Request", dict(zip(fields, values, strict=True))),
        st.tuples(*[FLOATS32] * len(fields)),
    )


ORDERED = st.one_of(
    timed(2, PAYLOADS),
    timed(4, service(TELEPORT, "x", "y", "theta")),
    timed(4, PAYLOADS),
    timed(5, service(SHIFT, "linear", "angular")),
    timed(6, st.builds(lambda theta: encode(f"{GOAL}_Request", {"goal": {"theta": theta}}), FLOATS32)),
    TIMES.map(lambda t: (t, jail.advance(t))),
)


def play(car: Car, frames: list[bytes], *, walls: bool = True) -> EpisodeResult:
    spec = EpisodeSpec(world=World(walls=walls), horizon_ns=HORIZON_NS, source=b"", file_name="a.py")
    return Episode(spec, car).run(FakeLink(frames))


def check(result: EpisodeResult, *, walls: bool = True) -> None:
    path = result.trajectory
    assert len(path) >= 1
    assert (np.diff(path.t_ns) > 0).all()
    assert path.t_ns[-1] <= path.end_ns <= HORIZON_NS
    assert result.duration_ns <= HORIZON_NS
    for column in (path.x_m, path.y_m, path.heading_rad, path.v_mps, path.w_radps):
        assert np.isfinite(column).all()
    if walls:
        assert 0.0 <= path.x_m.min() <= path.x_m.max() <= WINDOW_M
        assert 0.0 <= path.y_m.min() <= path.y_m.max() <= WINDOW_M


@settings(max_examples=examples(150))
@given(st.lists(FRAMES, max_size=12))
def test_any_frames_make_an_episode(car: Car, frames: list[bytes]) -> None:
    check(play(car, frames))


@settings(max_examples=examples(200))
@given(st.lists(ORDERED, max_size=12), st.booleans())
def test_any_commands_and_requests_make_the_same_episode_twice(
    car: Car, timed: list[tuple[int, bytes]], walls: bool
) -> None:
    in_order = [body for _, body in sorted(timed, key=lambda item: item[0])]
    frames = [*OPENING, *in_order, jail.ended(SECOND)]
    first, second = play(car, frames, walls=walls), play(car, frames, walls=walls)
    check(first, walls=walls)
    assert first.violation == second.violation
    assert first.notes == second.notes
    for name in ("t_ns", "x_m", "y_m", "heading_rad", "v_mps", "w_radps"):
        assert getattr(first.trajectory, name).tobytes() == getattr(second.trajectory, name).tobytes()
