"""Rotating to an angle: turtlesim's one action, as a script sees it."""

import math
from collections.abc import Generator
from typing import Any

import numpy as np
import pytest

from grader.sim.driving import Car
from tests.fakes.jail import SECOND, Answer, Script
from tests.unit.sim.student import ACTION, ROTATE, UUID, Student, run

TICK = 16_000_000


def goal(
    student: Student, theta: float, uuid: bytes = UUID
) -> Generator[bytes, Answer | None, dict[str, Any]]:
    return (
        yield from student.call(f"{ACTION}/send_goal", goal_id={"uuid": list(uuid)}, goal={"theta": theta})
    )


def result_of(student: Student, uuid: bytes = UUID) -> Generator[bytes, Answer | None, dict[str, Any]]:
    return (yield from student.call(f"{ACTION}/get_result", goal_id={"uuid": list(uuid)}))


def test_rotate_absolute_turns_and_reports(car: Car) -> None:
    student = Student()
    ends: list[dict[str, Any]] = []

    def story() -> Script:
        yield from student.subscribe(f"{ACTION}/feedback", f"{ROTATE}_FeedbackMessage")
        yield from student.subscribe(f"{ACTION}/status", "action_msgs/msg/GoalStatusArray")
        accepted = yield from goal(student, -1.5)
        assert accepted["accepted"]
        ends.append((yield from result_of(student)))
        ends.append((yield from result_of(student)))
        ends.append((yield from result_of(student, bytes(16))))

    path = run(car, student, story()).trajectory
    assert path.heading_rad[-1] == pytest.approx(-1.5, abs=0.02)
    assert ends[0]["status"] == ends[1]["status"] == 4
    assert ends[0]["result"]["delta"] == pytest.approx(1.5, abs=0.03)
    assert ends[2]["status"] == 0
    assert np.abs(path.w_radps).max() == pytest.approx(1.0, rel=1e-3)
    feedback = student.messages(f"{ACTION}/feedback", f"{ROTATE}_FeedbackMessage")
    assert feedback[0][1]["feedback"]["remaining"] == pytest.approx(-1.5)
    assert {t % TICK for t, _ in feedback} == {0}
    statuses = student.messages(f"{ACTION}/status", "action_msgs/msg/GoalStatusArray")
    assert [message["status_list"][0]["status"] for _, message in statuses][:1] == [2]
    assert statuses[-1][1]["status_list"][0]["status"] == 4


def test_a_velocity_command_aborts_the_rotation(car: Car) -> None:
    student = Student()
    ends: list[dict[str, Any]] = []

    def story() -> Script:
        yield from goal(student, 3.0)
        yield from student.wait(SECOND)
        yield from student.drive(0.5)
        ends.append((yield from result_of(student)))
        yield from student.wait(3 * SECOND)

    path = run(car, student, story()).trajectory
    assert ends[0]["status"] == 6
    assert path.heading_rad[-1] == pytest.approx(1.0, abs=0.05)
    assert np.hypot(path.x_m[-1] - path.x_m[0], path.y_m[-1] - path.y_m[0]) == pytest.approx(0.5, abs=0.02)


def test_a_new_goal_aborts_the_old_one(car: Car) -> None:
    student = Student()
    ends: list[dict[str, Any]] = []
    other = bytes([7] * 16)

    def story() -> Script:
        yield from goal(student, 3.0)
        yield from student.wait(SECOND)
        yield from goal(student, 0.0, other)
        assert not (yield from goal(student, 0.0, other))["accepted"]
        ends.append((yield from result_of(student)))
        ends.append((yield from result_of(student, other)))

    path = run(car, student, story()).trajectory
    assert [end["status"] for end in ends] == [6, 4]
    assert path.heading_rad[-1] == pytest.approx(0.0, abs=0.02)


def test_a_goal_is_cancelled(car: Car) -> None:
    student = Student()
    replies: list[dict[str, Any]] = []

    def cancel(uuid: bytes) -> Script:
        info = {"goal_id": {"uuid": list(uuid)}}
        replies.append((yield from student.call(f"{ACTION}/cancel_goal", goal_info=info)))

    def story() -> Script:
        yield from cancel(bytes(16))
        yield from goal(student, 3.0)
        yield from student.wait(SECOND)
        yield from cancel(bytes([9] * 16))
        yield from cancel(bytes(16))
        replies.append((yield from result_of(student)))
        yield from cancel(UUID)

    path = run(car, student, story()).trajectory
    rejected, unknown, cancelled, end, late = replies
    assert (rejected["return_code"], unknown["return_code"], late["return_code"]) == (1, 2, 3)
    assert cancelled["return_code"] == 0
    assert cancelled["goals_canceling"][0]["goal_id"]["uuid"] == UUID
    assert end["status"] == 5
    assert path.heading_rad[-1] == pytest.approx(1.0, abs=0.05)


def test_a_rotation_goes_on_when_the_script_has_ended(car: Car) -> None:
    student = Student()

    def story() -> Script:
        yield from goal(student, 2.0)

    result = run(car, student, story())
    assert result.trajectory.heading_rad[-1] == pytest.approx(2.0, abs=0.02)
    assert result.trajectory.end_ns < 3 * SECOND


@pytest.mark.parametrize("theta", [math.nan, math.inf])
def test_a_goal_that_is_no_angle_turns_until_it_is_cancelled(car: Car, theta: float) -> None:
    student = Student()
    replies: list[dict[str, Any]] = []

    def story() -> Script:
        yield from goal(student, theta)
        yield from student.wait(2 * SECOND)
        yield from student.call(f"{ACTION}/cancel_goal", goal_info={"goal_id": {"uuid": list(UUID)}})
        replies.append((yield from result_of(student)))

    path = run(car, student, story()).trajectory
    assert replies[0]["status"] == 5
    assert path.heading_rad[-1] == pytest.approx(2.0, abs=0.05)
