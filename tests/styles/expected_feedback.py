"""Scripts that listen to the turtle, call its services and actions, or talk among their own nodes."""

from math import pi

from grader.contracts.outcome import RunStatus
from tests.styles.expectation import Expectation, Plan, drive
from tests.styles.ideal import START, Jump, Leg

INTERRUPTED = RunStatus.INTERRUPTED
X0 = START[0]


def _approach(goal_x_m: float) -> Plan:
    """The legs of `v = distance` every 0.1 s, the distance taken from the last pose of 62.5 Hz."""
    legs: list[Leg] = []
    x, previous_v, tick = X0, 0.0, 0
    while True:
        tick += 1
        t_ms = 100 * tick
        seen = x - previous_v * (t_ms % 16) / 1e3
        distance = goal_x_m - seen
        if distance <= 0.05:
            return tuple(legs)
        legs.append(Leg(t_ms / 1e3, 0.1, distance))
        x, previous_v = x + 0.1 * distance, distance


EXPECTED = {
    "pose_until_x": Expectation(
        plan=(Leg(0.016, 8.0 - X0, 1.0),), status=INTERRUPTED, horizon_s=5.0, says=("到达 x=8.0",)
    ),
    # At 0.5 rad/s every 0.1 s, -pi/2 is first seen at the tick of 3.3 s.
    "pose_object_as_type": Expectation(
        plan=(Leg(0.1, 3.2, 0.0, -0.5),), status=INTERRUPTED, horizon_s=6.0, says=("右转完成",)
    ),
    "pose_until_heading": Expectation(
        plan=(Leg(0.02, pi / 2 / 0.5, 0.0, 0.5),), says=("90 degrees",), exit_code=0
    ),
    "pose_go_to_goal": Expectation(plan=_approach(8.5), stdout="reached True\n"),
    "pose_log_csv": Expectation(
        plan=(Leg(0.1, 2.0, 1.0),), stdout="logs/pose_20231114_221320.csv True True\n", exit_code=0
    ),
    # After two seconds of sleep the first pose is an old one, out of the queue.
    "global_pose_callback": Expectation(plan=(Leg(2.0, 1.5, 2.0),), stdout="moved\n"),
    "wait_for_message_start": Expectation(plan=(Leg(0.016, 4.0, 1.0),), stdout="True 5.544 5.544\n"),
    "teleport_in_constructor": Expectation(
        plan=(Jump(0.016, (2.0, 2.0, pi / 2)), Leg(0.116, 2.5, 1.0)),
        status=INTERRUPTED,
        says=("teleported: turtlesim.srv.TeleportAbsolute_Response()",),
    ),
    "set_pen_then_square": Expectation(
        plan=drive(0.016, *[(1.0, 1.0, 0.0), (1.0, 0.0, pi / 2)] * 4),
        says=("第1条边 颜色成功", "第4条边 颜色成功"),
    ),
    "spawn_kill_reset": Expectation(
        plan=(Leg(0.0, 1.0, 1.0), Jump(1.552, START), Leg(1.552, 2.0, 1.0)), stdout="friend\n''\n"
    ),
    # 1 rad/s to within 0.02 rad of the goal; the goal arrives at the tick of 0.016 s.
    "rotate_absolute_action": Expectation(
        plan=(Leg(0.016, 1.98, 0.0, 1.0),), says=("Goal accepted", "delta -2.0 feedback True"), exit_code=0
    ),
    "action_server_and_client": Expectation(
        plan=(Leg(0.0, 2.0, 0.0, 1.0),), stdout="4 2.0 20\n", says=("executing",)
    ),
    "async_callback": Expectation(
        plan=(Leg(0.416, 2.0, 1.0),),
        status=INTERRUPTED,
        says=tuple(f"{number}: Empty_Response" for number in range(1, 9)),
    ),
    "async_same_group_waits_for_ever": Expectation(
        plan=(Leg(0.0, 1.0, 1.0),), status=INTERRUPTED, stdout="asking\n"
    ),
    "call_in_callback_waits_for_ever": Expectation(
        plan=(Leg(0.5, 1.0, 1.0),), status=RunStatus.STALLED, stdout=""
    ),
    "call_in_callback_multithreaded": Expectation(
        plan=(Leg(0.1, 0.908, 1.0), Jump(1.008, (X0 + 0.908, START[1], pi / 2)), Leg(1.008, 0.992, 1.0)),
        status=INTERRUPTED,
        says=("turned by service",),
    ),
    "busy_future_without_spin": Expectation(plan=(Leg(0.0, 1.0, 1.0),), status=INTERRUPTED, stdout="None\n"),
    "busy_pose_without_spin": Expectation(
        plan=(Leg(0.0, 1.0, 0.0, 1.0),), status=INTERRUPTED, horizon_s=3.0, stdout=""
    ),
    "callback_without_argument": Expectation(
        plan=(Leg(0.01, 1.0, 0.0, 1.0),),
        status=RunStatus.CRASHED,
        error="TypeError",
        says=("takes 1 positional argument but 2 were given",),
    ),
    "several_nodes": Expectation(
        plan=drive(0.5, (2.0, 1.0, 0.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.0)),
        status=INTERRUPTED,
        says=(*['[legs]: I heard: "forward"'] * 4, *['I heard: "left"'] * 2, 'I heard: "stop"'),
    ),
    "own_service_server": Expectation(plan=(Leg(0.1, 2.0, 1.0, -0.5),), stdout="on\noff\n"),
    "tf2_follow_own_frame": Expectation(plan=(Leg(0.1, 2.0, 1.0),), status=INTERRUPTED, horizon_s=4.0),
    "color_sensor": Expectation(
        plan=(Leg(0.05, 2.05, 1.0),), status=INTERRUPTED, horizon_s=5.0, says=("paint 179 184 255",)
    ),
    "second_turtle": Expectation(
        plan=(Leg(0.116, 2.0, 1.0),),
        says=(
            "subscribers before: 0",
            "turtle2: 1 subscriber",
            "caught",
            "gone: True 0",
        ),
        exit_code=0,
    ),
    # The wall is 2.5 m away at 0.1 s and 0.1 m nearer each tick: 0.5 m at 2.1 s.
    "point_cloud_obstacle": Expectation(plan=(Leg(0.1, 2.0, 1.0),), status=INTERRUPTED, horizon_s=4.0),
    "subscription_count_wait": Expectation(plan=(Leg(0.0, 2.0, 1.0),), stdout="1\n"),
}
