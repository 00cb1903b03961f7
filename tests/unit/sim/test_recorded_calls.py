"""Recorded PyBullet calls on the trusted side: what the shim writes is read as it was, all else is refused."""

import importlib.util
import math
import re
import struct
from contextlib import suppress
from pathlib import Path
from types import BuiltinFunctionType

import pybullet
import pytest
from hypothesis import given
from hypothesis import strategies as st

import grader
from grader.contracts.errors import ProtocolError
from grader.contracts.trajectory import Picture, decode_trajectory, encode_trajectory
from grader.formats.png import png_of
from grader.sim.recorded_calls import (
    FUNCTIONS,
    KINDS,
    MOST_CALLS,
    PARAMETERS,
    TRICK_RULES,
    RecordedCalls,
    read_calls,
)
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


def kinds(name: str, *args: object, **options: object) -> tuple[str | None, str | None]:
    """Return what a call is before the first step, and later."""
    found = recorded((name, list(args), options)).suspects
    return (found[0].before, found[0].after) if found else (None, None)


def test_both_sides_number_the_functions_alike() -> None:
    assert FUNCTIONS == calls.RECORDED
    assert {name: tuple(names) for name, names in PARAMETERS.items()} == calls.PARAMETERS


def test_the_table_has_every_function_of_pybullet() -> None:
    functions = {name for name, each in vars(pybullet).items() if isinstance(each, BuiltinFunctionType)}
    assert functions == KINDS.keys()
    assert set(KINDS.values()) == {
        "step",
        "motor",
        "world",
        "trick",
        "looks",
        "computes",
        "window",
        "refused",
    }


def test_there_is_a_rule_for_each_function_that_may_be_a_trick() -> None:
    assert {name for name, kind in KINDS.items() if kind == "trick"} == TRICK_RULES.keys()


def _refusal(name: str, args: list[object], options: dict[str, object]) -> str:
    """Return why PyBullet refuses a call, once it has a number or a text wherever it asks for one."""
    for _ in range(40):
        try:
            getattr(pybullet, name)(*args, **options)
        except (TypeError, pybullet.error) as error:
            text = str(error)
        if (missing := re.search(r"required argument '(\w+)'", text)) is not None:
            options[missing[1]] = 0
        elif (wrong := re.search(r"argument (\d+) must be str", text)) is not None:
            place = int(wrong[1]) - 1
            if place < len(args):
                args[place] = ""
            else:
                options[PARAMETERS[name][place]] = ""
        else:
            return text
    raise AssertionError(text)


@pytest.mark.parametrize("name", sorted(set(FUNCTIONS) - {"connect", "setJointMotorControl"}))
def test_parameters_stand_where_pybullet_has_them(name: str) -> None:
    """PyBullet says how many arguments it takes, and refuses one that is passed by its place and by its name."""
    names = PARAMETERS[name]
    assert re.search(
        rf"takes at most {len(names)} (keyword )?argument", _refusal(name, [0] * (len(names) + 1), {})
    )
    for place, parameter in enumerate(
        names[:-1] if KINDS[name] != "motor" else ()
    ):  # those have older names, too
        refusal = _refusal(name, [0] * (place + 1), {parameter: 0})
        assert f"given by name ('{parameter}') and position ({place + 1})" in refusal
    assert names[-1] == "physicsClientId"
    assert "connected" in _refusal(name, [], {"physicsClientId": 77})


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


PLACE, TURN = [0, 0, 1], [0, 0, 0, 1]
ALLOWED, LATER = (None, None), (None, "jump")


@pytest.mark.parametrize(
    ("call", "options", "expected"),
    [
        (("resetBasePositionAndOrientation", 1, PLACE, TURN), {}, LATER),
        (("resetBasePositionAndOrientation",), {"bodyUniqueId": 1, "posObj": PLACE, "ornObj": TURN}, LATER),
        (("resetJointState", 1, 2, 0.5, 0.0), {}, LATER),
        (("resetJointState", 1, 2, 0.5, 3.0), {}, ("jump", "jump")),
        (("resetJointState", 1, 2, 0.5), {"targetVelocity": 3}, ("jump", "jump")),
        (("resetJointStateMultiDof", 1, 2, [0.5]), {}, LATER),
        (("resetJointStateMultiDof", 1, 2, [0.5], [9.0]), {}, ("jump", "jump")),
        (("resetJointStatesMultiDof", 1, [2], [[0.5]]), {"targetVelocities": [[9.0]]}, ("jump", "jump")),
        (("resetBaseVelocity", 1, [0, 0, 0]), {}, LATER),
        (("resetBaseVelocity", 1), {"angularVelocity": [0, 0, 1]}, ("jump", "jump")),
        (("applyExternalForce", 1, -1, PLACE, PLACE, 1), {}, ("push", "push")),
        (("createConstraint", 1, 2, 3, -1, 4, [0], [0], [0]), {}, ("constraint", "constraint")),
        (("createConstraint", 1, 9, 1, 10, 6, [0], [0], [0]), {}, ALLOWED),  # gears of one body
        (("createConstraint", 1, 9, 1, 10, 5, [0], [0], [0]), {}, ("constraint", "constraint")),
        (("changeConstraint", 1), {"gearRatio": -1, "maxForce": 10}, ALLOWED),
        (("changeConstraint", 1), {"relativePositionTarget": 1.0}, ("constraint", "constraint")),
        (("changeDynamics", 1, -1), {"lateralFriction": 1.0}, ALLOWED),
        (("changeDynamics", 1, -1, -1, 1.0), {}, ALLOWED),  # a mass of -1: as it was
        (("changeDynamics", 1, -1), {"mass": 0}, ("dynamics", "dynamics")),
        (("changeDynamics", 1, -1, 0), {}, ("dynamics", "dynamics")),
        (("changeDynamics", 1, -1), {"linearDamping": 9.0}, (None, "dynamics")),
        (("changeDynamics", 1, -1), {"activationState": 4}, ("dynamics", "dynamics")),
        (("setCollisionFilterPair", 1, 2, -1, -1, 0), {}, ("collision", "collision")),
        (("setCollisionFilterPair", 1, 2, -1, -1, 1), {}, ALLOWED),
        (("setCollisionFilterPair", 1, 1, 3, 4, 0), {}, ALLOWED),  # links of one body
        (("setGravity", 0, 0, -9.8), {}, (None, "gravity")),
        (("setTimeStep", 0.01), {}, ALLOWED),
        (("setTimeStep", 1.0), {}, ("time_step", "time_step")),
        (("setPhysicsEngineParameter",), {"fixedTimeStep": 1e-5}, ("time_step", "time_step")),
        (("removeBody", 1), {}, (None, "removed")),
        (("loadURDF", "a.urdf", PLACE, TURN, 0, 0, 0, 2.0), {}, ("dynamics", "dynamics")),
        (("loadSDF", "a.sdf", 0, 2.0), {}, ("dynamics", "dynamics")),
    ],
)  # fmt: skip
def test_what_no_motor_does_is_found(
    call: tuple[object, ...], options: dict[str, object], expected: tuple[str | None, str | None]
) -> None:
    assert kinds(str(call[0]), *call[1:], **options) == expected
    assert kinds(str(call[0]), *call[1:], **options, physicsClientId=1) == ALLOWED


def test_a_client_is_read_by_its_place_as_by_its_name() -> None:
    assert kinds("setGravity", 0, 0, 9.8, 1) == ALLOWED
    assert kinds("applyExternalTorque", 1, -1, PLACE, 1, 1) == ALLOWED
    assert kinds("changeDynamics", 1, -1, 0, *[-1] * 21, 1) == ALLOWED
    assert recorded(("stepSimulation", [1], {}), ("stepSimulation", [0], {})).steps == 1
    old = ["a.urdf", 0, 0, 1, 0, 0, 0, 1]  # the last number is no client
    assert recorded(("loadURDF", old, {})).files == {0: "a.urdf"}
    for name, args in (("setGravity", [0, 0, 9.8, 1]), ("loadURDF", old), ("stepSimulation", [])):
        theirs = read_calls(calls.encode(FUNCTIONS.index(name), args, {}))[0].is_of_first_client
        assert theirs == (calls.client_of(name, args, {}) == 0)


def test_the_first_step_of_a_world_is_one_that_was_taken() -> None:
    step: tuple[str, list[object], dict[str, object]] = ("stepSimulation", [], {})
    some = recorded(step, ("resetSimulation", [], {}), step, step)
    assert (some.first_step(0, ()), some.first_step(2, ()), some.first_step(2, {2})) == (0, 2, 3)
    assert some.first_step(4, ()) == some.count == 4
    assert some.steps == 2


def test_pictures_stay_in_a_trajectory() -> None:
    shown = (Picture(t_ns=5, png=png_of(1, 1, b"\1\2\3")),)
    assert decode_trajectory(encode_trajectory(planar(replayed(pictures=shown)))).pictures == shown
    assert b"pictures" not in encode_trajectory(planar(replayed()))
