"""Recorded PyBullet calls on the trusted side: what the shim writes is read as it was, all else is refused."""

import importlib.util
import math
import struct
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import grader
from grader.contracts.errors import ProtocolError
from grader.contracts.trajectory import Picture, decode_trajectory, encode_trajectory
from grader.formats.png import png_of
from grader.sim.recorded_calls import FUNCTIONS, MOST_CALLS, RecordedCalls, read_calls
from grader.sim.replay import planar
from tests.unit.sim.replays import replayed

SHIM = Path(grader.__file__).parent / "shim" / "rclpy" / "_pybullet" / "calls.py"
_spec = importlib.util.spec_from_file_location("calls_under_test", SHIM)
assert _spec is not None
assert _spec.loader is not None
calls = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(calls)

HORIZON_NS = 60_000_000_000
STEP = calls.encode(0, [], {})

values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(1 << 63), (1 << 63) - 1)
    | st.floats(allow_nan=False)
    | st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=20),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=12,
)
names = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,39}", fullmatch=True)


def recorded(*made: tuple[str, list[object], dict[str, object]]) -> RecordedCalls:
    found = RecordedCalls()
    frame = b"".join(calls.encode(FUNCTIONS.index(name), args, options) for name, args, options in made)
    found.take(frame, HORIZON_NS)
    return found


def kinds(*made: tuple[str, list[object], dict[str, object]]) -> list[str]:
    return [one.kind for one in recorded(*made).tricks]


def test_both_sides_number_the_functions_alike() -> None:
    assert FUNCTIONS == calls.RECORDED


@given(
    st.sampled_from(range(len(FUNCTIONS))),
    st.lists(values, max_size=6),
    st.dictionaries(names, values, max_size=4),
)
def test_what_the_shim_writes_is_read_as_it_was(
    number: int, args: list[object], options: dict[str, object]
) -> None:
    plain = [calls.plain(each) for each in args], {key: calls.plain(each) for key, each in options.items()}
    (call,) = read_calls(calls.encode(number, *plain))
    assert (call.name, list(call.args), dict(call.options)) == (FUNCTIONS[number], *plain)
    (again,) = calls.read(calls.encode(number, *plain), 0)
    assert again == (number, *plain)


@given(st.binary(max_size=200))
def test_any_bytes_are_calls_or_refused_in_one_way(data: bytes) -> None:
    found = RecordedCalls()
    with suppress(ProtocolError):
        found.take(data, HORIZON_NS)
    assert found.count <= len(data) // 3


@pytest.mark.parametrize(
    "bad",
    [
        b"\xff\0\0",
        b"\0\x01",
        b"\0\x21" + b"\0" * 34,
        b"\0\0\x01\x03a b\0",
        b"\0\0\x02\x01a\0\x01a\0",
        b"\0\x01\x09",
        b"\0\x01" + b"\x06\x01\x00" * 5 + b"\0\0",
        b"\0\x01\x05\x02\x00\xff\xff\0",
        b"\0\x01\x05\x01\x00\0\0",
        b"\0\x01\x05" + struct.pack("<H", 1_025) + b"a" * 1_025 + b"\0",
        b"\0\x01\x07" + struct.pack("<H", 20_001) + bytes(8 * 20_001) + b"\0",
    ],
)
def test_what_is_not_exactly_a_call_is_refused(bad: bytes) -> None:
    with pytest.raises(ProtocolError, match=r"^CALLS: call 0 "):
        RecordedCalls().take(bad, HORIZON_NS)


def test_calls_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    assert MOST_CALLS == 150_000
    monkeypatch.setattr("grader.sim.recorded_calls.MOST_CALLS", 5_000)
    found = RecordedCalls()
    frame = calls.encode(FUNCTIONS.index("setDefaultContactERP"), [0], {}) * 1_000
    for _ in range(5):
        found.take(frame, HORIZON_NS)
    with pytest.raises(ProtocolError, match="more than 5000 calls"):
        found.take(frame, HORIZON_NS)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_from_a_number_that_is_not_finite_on_nothing_counts(bad: float) -> None:
    found = recorded(("setGravity", [0, 0, -9.8], {}), ("loadURDF", ["a.urdf", [0, [bad], 0]], {}))
    assert (found.not_finite, found.count, found.frames) == (1, 0, [])
    found.take(STEP, HORIZON_NS)
    assert found.steps == 0


def test_what_no_motor_does_is_found() -> None:
    step: tuple[str, list[object], dict[str, object]] = ("stepSimulation", [], {})
    assert kinds(("resetBasePositionAndOrientation", [1, [0, 0, 1], [0, 0, 0, 1]], {}), step) == []
    assert kinds(step, ("resetBasePositionAndOrientation", [1, [0, 0, 1], [0, 0, 0, 1]], {})) == ["jump"]
    assert kinds(("resetJointState", [1, 2, 0.5, 0.0], {}), step) == []
    assert kinds(("resetJointState", [1, 2, 0.5], {"targetVelocity": 3}), step) == ["jump"]
    assert kinds(("resetBaseVelocity", [1, [0, 0, 0]], {}), step) == []
    assert kinds(("resetBaseVelocity", [1], {"angularVelocity": [0, 0, 1]})) == ["jump"]
    assert kinds(("applyExternalForce", [1, -1, [0, 0, 1], [0, 0, 0], 1], {})) == ["push"]
    assert kinds(("createConstraint", [1, 2, 3, -1, 4, [0], [0], [0]], {})) == ["constraint"]
    assert kinds(("createConstraint", [1, 9, 1, 10, 4, [0], [0], [0]], {})) == []  # two links of one body
    assert kinds(("changeDynamics", [1, -1], {"lateralFriction": 1.0})) == []
    assert kinds(("changeDynamics", [1, -1], {"mass": 0})) == ["dynamics"]
    assert kinds(("changeDynamics", [1, -1, 0], {})) == ["dynamics"]
    assert kinds(("setCollisionFilterPair", [1, 2, -1, -1, 0], {})) == ["collision"]
    assert kinds(("setGravity", [0, 0, -9.8], {}), step, ("setGravity", [0, 0, -9.8], {})) == []
    assert kinds(("setGravity", [0, 0, -9.8], {}), step, ("setGravity", [0, 0, 9.8], {})) == ["gravity"]
    assert kinds(("setTimeStep", [0.01], {})) == []
    assert kinds(("setTimeStep", [1.0], {})) == ["time_step"]
    assert kinds(("setPhysicsEngineParameter", [], {"fixedTimeStep": 1e-5})) == ["time_step"]
    assert kinds(("applyExternalForce", [1, -1, [0, 0, 1], [0, 0, 0], 1], {"physicsClientId": 1})) == []


def test_a_reset_that_is_followed_by_a_step_begins_anew() -> None:
    step: tuple[str, list[object], dict[str, object]] = ("stepSimulation", [], {})
    push: tuple[str, list[object], dict[str, object]] = ("applyExternalForce", [1, -1, [0], [0], 1], {})
    assert recorded(step, push, step, ("resetSimulation", [], {})).steps == 2
    anew = recorded(step, push, step, ("resetSimulation", [], {}), step)
    assert (anew.steps, anew.tricks, anew.first_call) == (1, [], 3)
    again = recorded(step, push, step, ("disconnect", [], {}), ("connect", [1], {}), step)
    assert (again.steps, again.tricks, again.first_call) == (1, [], 3)
    assert recorded(step, push, step, ("disconnect", [], {})).steps == 2


def test_pictures_stay_in_a_trajectory() -> None:
    shown = (Picture(t_ns=5, png=png_of(1, 1, b"\1\2\3")),)
    assert decode_trajectory(encode_trajectory(planar(replayed(pictures=shown)))).pictures == shown
    assert b"pictures" not in encode_trajectory(planar(replayed()))
