"""A chat agent's tool calls in an episode: against the car, and against a script with services and topics."""

from typing import Any

import pytest

from grader.contracts.assignment import AgentStep, InterfaceDefinition
from grader.contracts.outcome import AgentResult
from grader.sim.cdr import encode
from grader.sim.driving import Car
from grader.sim.episode import EpisodeResult
from tests.fakes import jail
from tests.fakes.jail import SECOND, Script
from tests.unit.sim.playing import end_pose, play

TRIGGER = "std_srvs/srv/Trigger"
TWIST = "geometry_msgs/msg/Twist"
TEXT = "std_msgs/msg/String"
CMD = "/turtle1/cmd_vel"
SERVICE, TALKER, LISTENER = 31, 32, 33


def step(at_s: float, tool: Any, target: str, type: str, **more: Any) -> AgentStep:
    return AgentStep(at_ns=round(at_s * SECOND), tool=tool, target=target, type=type, **more)


def run(car: Car, script: Script, *steps: AgentStep) -> tuple[EpisodeResult, tuple[AgentResult, ...]]:
    result = play(car, script, agent=steps)
    assert result.violation is None
    return result, result.agent


def idle(until_s: float) -> Script:
    yield jail.node()
    yield from waiting(until_s)
    yield jail.ended(round(until_s * SECOND))


def waiting(until_s: float) -> Script:
    now_ns = 0
    while now_ns < until_s * SECOND:
        answer = yield jail.advance(round(until_s * SECOND))
        assert answer is not None
        now_ns = answer.now_ns


def test_the_agent_drives_by_itself_and_reads_where_it_is(car: Car) -> None:
    result, (drive, read, turn) = run(
        car,
        idle(10.0),
        step(1.0, "publish", CMD, TWIST, values={"linear": {"x": 1}}),
        step(3.0, "read", "/turtle1/pose", "turtlesim/msg/Pose"),
        step(
            3.0, "goal", "/turtle1/rotate_absolute", "turtlesim/action/RotateAbsolute", values={"theta": 1.0}
        ),
    )
    x, _, heading = end_pose(result)
    assert x == pytest.approx(1.008)
    assert heading == pytest.approx(1.0, abs=0.03)
    assert (drive.sent_ns, drive.answered_ns) == (SECOND, SECOND)
    assert read.values is not None
    assert read.values["x"] == pytest.approx(5.544445 + 1.008, abs=1e-5)
    assert turn.values is not None
    assert turn.values["delta"] == pytest.approx(-1.0, abs=0.03)
    assert turn.sent_ns == read.answered_ns  # one after the other


def test_a_script_that_runs_ahead_is_driven_between_its_frames(car: Car) -> None:
    def script() -> Script:
        yield jail.node()
        yield jail.driver(21, 0)
        yield jail.publish(21, 5 * SECOND, jail.twist(0.0, 0.0))
        yield jail.ended(6 * SECOND)

    result, (drive,) = run(car, script(), step(1.0, "publish", CMD, TWIST, values={"linear": {"x": 1}}))
    assert drive.sent_ns == SECOND
    assert end_pose(result)[0] == pytest.approx(1.008)


def test_a_service_is_waited_for_called_and_answered(car: Car) -> None:
    def script() -> Script:
        yield jail.node()
        yield jail.entity(SERVICE, 4, SECOND, name="/say", type=TRIGGER)
        answer = yield jail.advance(20 * SECOND)
        assert answer is not None
        (what, identity, sequence, t_ns, _) = answer.events[0]
        assert (what, identity, t_ns) == (3, SERVICE, SECOND)
        payload = encode(f"{TRIGGER}_Response", {"success": True, "message": "here"})
        yield jail.response(SERVICE, sequence, 4 * SECOND, payload)
        yield from waiting(12.0)
        yield jail.ended(12 * SECOND)

    _, (said, missing) = run(
        car, script(), step(0.5, "call", "/say", TRIGGER), step(5.0, "call", "/nothing", TRIGGER)
    )
    assert (said.sent_ns, said.answered_ns) == (SECOND, 4 * SECOND)
    assert said.values == {"success": True, "message": "here"}
    assert (missing.sent_ns, missing.answered_ns) == (None, None)
    assert missing.reason == "Service /nothing does not exist"


def test_a_call_that_is_never_answered_is_given_up_and_the_next_step_comes(car: Car) -> None:
    def script() -> Script:
        yield jail.node()
        yield jail.entity(SERVICE, 4, 0, name="/say", type=TRIGGER)
        yield from waiting(50.0)
        yield jail.ended(50 * SECOND)

    _, (silent, after) = run(
        car, script(), step(1.0, "call", "/say", TRIGGER), step(2.0, "publish", CMD, TWIST)
    )
    assert (silent.sent_ns, silent.answered_ns) == (SECOND, None)
    assert after.sent_ns == 31 * SECOND


def test_agent_and_script_talk_on_topics_of_their_own(car: Car) -> None:
    heard: list[bytes] = []

    def script() -> Script:
        yield jail.node()
        yield jail.entity(LISTENER, 3, 0, name="/say", type=TEXT)
        yield jail.entity(TALKER, 2, 0, name="/told", type=TEXT)
        answer = yield jail.advance(20 * SECOND)
        assert answer is not None
        heard.extend(event[-1] for event in answer.events if event[1] == LISTENER)
        yield jail.publish(TALKER, 3 * SECOND, encode(TEXT, {"data": "at home"}))
        yield from waiting(5.0)
        yield jail.ended(5 * SECOND)

    _, (_, read) = run(
        car,
        script(),
        step(1.0, "publish", "/say", TEXT, values={"data": "where are you?"}),
        step(2.0, "read", "/told", TEXT),
    )
    assert heard == [encode(TEXT, {"data": "where are you?"})]
    assert read.values == {"data": "at home"}


def test_an_answer_that_nobody_asked_for_is_a_violation(car: Car) -> None:
    def script() -> Script:
        yield jail.node()
        yield jail.entity(SERVICE, 4, 0, name="/say", type=TRIGGER)
        yield jail.response(SERVICE, (1 << 20) + 5, 0, encode(f"{TRIGGER}_Response"))

    result = play(car, script(), agent=(step(1.0, "call", "/say", TRIGGER),))
    assert "not awaited" in (result.violation or "")


def test_interfaces_of_the_assignment_are_spoken(car: Car) -> None:
    lines = "my_msgs/srv/Move 0\n=Move_Request\ndistance double\n=Move_Response\nok boolean"
    own = InterfaceDefinition(name="my_msgs/srv/Move", lines=lines)
    call = step(1.0, "call", "/move", "my_msgs/srv/Move", values={"distance": 2})
    result = play(car, idle(6.0), agent=(call,), interfaces=(own,))
    assert result.agent[0].reason == "Service /move does not exist"
