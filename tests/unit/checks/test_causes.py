"""Causes that the script shows, and scripts whose line only looks like the cause."""

import time
from dataclasses import replace

import pytest

from grader.checks.causes import with_causes
from grader.checks.measure import Findings, Mistake
from grader.checks.remarks import unchanged_counter
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY
from grader.messages.script import ScriptText
from tests.unit.checks.shipped import assignment
from tests.unit.checks.trajectories import drive, run_of

AT_REST = drive([(2.0, 0.0, 0.0)])


def cause(code: str, source: str, task: str = "square", case: str = "default") -> str:
    """Return the code that takes the place of `code` for a script."""
    found = assignment(task)
    findings = Findings(measures={}, mistakes=(Mistake(code, EMPTY, ()),))
    return with_causes(found.in_case(case), _run(source, case), findings).mistakes[0].code


def _run(source: str, case: str, status: RunStatus = RunStatus.FINISHED) -> Run:
    plain = run_of(AT_REST, status)
    return replace(plain, case=case, source=source)


SIDES = """
def tick(self):
    if self.n < 4 and self.k < 20:
        drive()
    elif self.n < 4 and self.k < 35:
        turn()
    if self.n < 4:
        self.k += 1
    if self.k >= 36:
        self.k = 0
{last}
node.create_timer(0.1, node.tick)
"""
TICKS = (
    "class A(Node):\n    def __init__(self):\n        self.create_timer({period}, self.tick)\n        self.n = 0\n"
    "    def tick(self):\n        self.n += 1\n        if self.n <= {count}:\n            go()\n"
)
PASS = (
    "class A(Node):\n    def __init__(self):\n        self.create_subscription(Pose, '/p', self.cb, 10)\n"
    "    def cb(self, msg):\n        pass\n    def {name}(self):\n        pass\n    def run(self):\n"
    "        self.{name}()\n"
)
ANEW = "def tick():\n{count}\n{then}\n    if n < 20:\n        go()\nnode.create_timer(0.1, tick)\n"
DEAF = (
    "class A(Node):\n    def __init__(self):\n        self.create_subscription(Pose, '/p', self.hear, 10)\n"
    "    def hear(self, msg):\n        self.pose = msg\n    def step(self):\n        rclpy.spin_once(self)\n"
    "    def run(self):\n        while self.pose.x < 7.0:\n            {block}\n"
)
HEARD = (
    "class A(Node):\n    def __init__(self):\n        self.create_subscription(Pose, '/p', self.hear, 10)\n"
    "        self.pose = None\n    def hear(self, msg):\n        {kept}\n    def tick(self):\n"
    "        if self.pose is None:\n            return\n        go()\n"
)
NANOSECONDS = "d = 2.0\nb = now().nanoseconds\nwhile now().nanoseconds - b < {limit}:\n    go()\n"
ONE_START = """
class A(Node):
    def __init__(self):
        self.t0 = time.time()
        self.create_timer(0.1, self.tick)
    def tick(self):
        passed = time.time() - self.t0
        if passed > self.limit:
            self.{count} += 1
            {more}
"""
FAR = (
    "class A(Node):\n    def __init__(self):\n        self.create_subscription(Pose, '/p', self.hear, 10)\n"
    "    def hear(self, msg):\n        self.pose = msg\n"
    "    def far(self):\n        return abs(self.pose.x - 7.0)\n"
    "    def run(self):\n        while self.far() > 0.1:\n            {block}\n"
)
GLOBAL = (
    "current = None\ndef hear(msg):\n    {first}\n    current = msg\n"
    "node.create_subscription(Pose, '/p', hear, 10)\n"
)
KEPT = "def tick():\n    go()\nnode.create_timer(0.1, tick)\n{loop}\n    {block}\n"
LOST = (
    "class A(Node):\n    def hear(self, msg):\n        self.p = {value}\n    def tick(self):\n"
    "        if not self.p:\n            return\n        pub.publish(m)\n{more}node.create_timer(0.1, node.tick)\n"
)
STATES = "self.state = 'turn'\nself.state = 'turning'\nif self.state == '{asked}':\n    go()\n"
MEASURED = (
    "def tick(self):\n    if self.sides >= 4:\n        return\n    if {condition}:\n        self.sides += 1\n"
    "node.create_timer(0.02, node.tick)\n"
)
GROWS = "for i in range(4):\n    {line}\n"


@pytest.mark.parametrize(
    ("code", "source", "wanted"),
    [
        ("only_stops", "t = 3 * 1 // 2", "only_stops"),
        ("turn_too_short", "t = 8 * math.pi // 7", "turn_too_short"),
        ("no_turns", "v = -1.0\nturn_time = 1.57 / v\ngo(abs(turn_time))", "no_turns"),
        ("no_turns", "second_angle = -1.57 / 2", "no_turns"),
        ("no_turns", PASS.format(name="turn"), "empty_function"),
        ("no_turns", PASS.format(name="log_pose"), "no_turns"),
        ("turns_too_short", "tolerance = math.radians(5)", "turns_too_short"),
        ("turns_too_short", "a = math.radians(math.pi / 2 * 180 / math.pi)", "turns_too_short"),
        ("turns_too_short", "a = math.radians(x * 180 / math.pi)", "turns_too_short"),
        ("place_lost", "pose.theta = msg.theta * 180\na = math.radians(pose.theta)", "place_lost"),
        ("place_lost", "tolerance, a = math.radians(5), math.radians(theta_deg)", "place_lost"),
        ("place_away", "e = math.degrees(math.atan2(dy, dx)) - pose.theta * 57.3", "place_away"),
        ("place_away", "e = math.degrees(math.atan2(dy, dx)) - math.degrees(pose.theta)", "place_away"),
        ("place_away", "log(math.degrees(pose.theta))\ne = math.atan2(dy, dx) - pose.theta", "place_away"),
        ("place_away", "e = math.degrees(a)\nmsg.angular.z = 0.05 * e", "place_away"),  # a gain per degree
        ("turn_too_short", TICKS.format(period=0.1, count=55), "turn_too_short"),
        ("turns_too_short", SIDES.format(last="        self.n += 1"), "turns_too_short"),
        ("only_stops", "t = time.time()\nif t - start < 2:\n    go()\n", "only_stops"),
        ("only_stops", "t = time.time() - start\nif t < 2:\n    go()\n", "only_stops"),
        ("only_stops", "t = time.time()\nif t < until:\n    go()\n", "only_stops"),
        ("no_turns", DEAF.format(block="self.pub.publish(m)"), "deaf_loop"),
        ("no_turns", DEAF.format(block="rclpy.spin_once(self)"), "no_turns"),
        ("no_turns", DEAF.format(block="self.step()"), "no_turns"),
        (
            "no_turns",
            DEAF.format(block="self.pub.publish(m)") + "Thread(target=spin, args=(a,)).start()\n",
            "no_turns",
        ),
        ("side_goes_on", DEAF.format(block="self.pub.publish(m)"), "deaf_loop"),
        ("no_turns", "msg.angular.y = 1.0", "other_axis"),
        ("only_stops", "msg.linear.z = v", "other_axis"),
        ("no_turns", "msg.angular.y = 0.0", "no_turns"),
        ("never_stops", "self.n = +x\n", "never_stops"),
        ("only_stops", "while time.time() - start < 2.0:\n    pub.publish(m)\n", "only_stops"),
        ("no_turns", ANEW.format(count="    n = 0", then="    n += 1\n    n += 1"), "no_turns"),
        ("no_turns", ANEW.format(count="    n = 0", then="    n += 1").replace("20", "1"), "no_turns"),
        ("no_turns", ANEW.format(count="    global n", then="    n += 1"), "no_turns"),
        (
            "no_turns",
            ANEW.format(count="    n = 0", then="    for i in range(3):\n        n += 1"),
            "no_turns",
        ),
        ("no_final_stop", "def stop():\n    pub.publish(Twist())\ngo()\nstop\n", "not_called"),
        ("turns_too_short", "turn_time = 1.57\nturn(turn_time)\ngo(move_time)", "turns_too_short"),
        ("one_corner_off", GROWS.format(line="drive((-1.0) ** i)"), "one_corner_off"),
        ("unequal_sides", GROWS.format(line="target = start + i * 1.57"), "unequal_sides"),
        ("never_spun", "node.create_timer(0.1, tick)\nrclpy.spin_once(node)\n", "spin_once"),
        ("not_spinning", "rclpy.spin_once(node)\n", "spin_once"),
        ("sides_missing", "for x in xs:\n    go(x)\n    xs.remove(x)\n", "removes_in_loop"),
        (
            "sides_missing",
            "for x in xs:\n    if x > 3:\n        xs.remove(x)\n        break\n",
            "sides_missing",
        ),
        ("never_stops", "while n < 4:\n    go()\n", "never_stops"),  # it did end
        ("publish_not_reached", HEARD.format(kept="pose = msg"), "kept_local"),
        ("no_drive_by_pose", HEARD.format(kept="pose = msg.theta"), "kept_local"),
        ("publish_not_reached", HEARD.format(kept="self.pose = msg"), "publish_not_reached"),
        (
            "publish_not_reached",
            HEARD.format(kept="pose = msg\n        self.pose = pose"),
            "publish_not_reached",
        ),
        ("swings", "yaw = 2 * msg.pose.pose.orientation.z", "swings"),
        ("swings", "yaw = math.copysign(2 * math.acos(q.w), q.z)", "swings"),
        ("place_away", "a = math.atan2(dy, dx)", "place_away"),
        ("place_away", "a = math.atan2(b, c)", "place_away"),
        ("place_away", "dx = gx - self.pose.x\na = math.atan2(dy, dx)", "place_away"),
        ("place_away", "step = self.pose.x - self.last_pose.x\na = math.atan2(dy, step)", "place_away"),
        ("place_never_stops", "if distance < 0.1:\n    stop()", "place_never_stops"),
        ("place_never_stops", "if angle < 0.001:\n    stop()", "place_never_stops"),
        ("never_finished", "if state == 0:\n    go()", "never_finished"),
        ("never_finished", "if self.target_angle is None or self.angle == None:\n    go()", "never_finished"),
        ("turns_too_far", "self.target += 90\na = math.radians(self.target)", "turns_too_far"),
        ("turns_too_far", "self.target += 9", "turns_too_far"),
        ("turns_too_far", "self.target = self.theta + 90 * math.pi / 180", "turns_too_far"),
        ("turns_too_far", "theta = math.degrees(msg.theta)\ntarget = theta + 90", "turns_too_far"),
        ("turns_too_short", "if abs(err) < 0.02:\n    stop()", "turns_too_short"),
        ("turns_too_short", "if abs(dist) < 0.3:\n    stop()", "turns_too_short"),
        ("waits_in_loop", KEPT.format(loop="while True:", block="time.sleep(1)"), "loop_for_spin"),
        ("cpu_limit", KEPT.format(loop="while rclpy.ok():", block="pass"), "loop_for_spin"),
        ("waits_in_loop", KEPT.format(loop="while rclpy.ok():", block="rclpy.spin_once(n)"), "waits_in_loop"),
        ("waits_in_loop", KEPT.format(loop="while not ready:", block="time.sleep(1)"), "waits_in_loop"),
        ("cpu_limit", KEPT.format(loop="while True:", block="pub.publish(m)"), "cpu_limit"),
        ("no_turns", DEAF.format(block="self.go()") + "    def go(self):\n        self.step()\n", "no_turns"),
        ("place_missed", FAR.format(block="time.sleep(0.1)"), "deaf_loop"),
        ("place_missed", FAR.format(block="rclpy.spin_once(self)"), "place_missed"),
        ("never_finished", STATES.format(asked="Turn") + "self.state = following\n", "never_finished"),
        ("sides_missing", "h = pose.theta / math.pi * 180\ngoal = self.heading + 90\n", "sides_missing"),
        ("side_goes_on", "self.sign_angle = 1\nif self.sign_angle == 1:\n    go()\n", "side_goes_on"),
        ("place_away", "self.theta = p.theta * 57.3\na = math.radians(self.theta)", "place_away"),
        ("place_away", "log.info(str(math.radians(pose.theta)))", "place_away"),
        ("waits_without_spin", "threading.Thread(target=self.go()).start()\n", "thread_runs_here"),
        ("waits_without_spin", "threading.Thread(target=self.go).start()\n", "waits_without_spin"),
        ("side_goes_on", GLOBAL.format(first="print(msg.x)"), "kept_global"),
        ("side_goes_on", GLOBAL.format(first="global current"), "side_goes_on"),
        ("log_not_reached", "self.get_logger().set_level(LoggingSeverity.WARN)\n", "level_raised"),
        ("log_not_reached", "self.get_logger().set_level(LoggingSeverity.DEBUG)\n", "log_not_reached"),
        ("publish_not_reached", LOST.format(value="msg", more=""), "never_called"),
        ("publish_not_reached", LOST.format(value="False", more=""), "publish_not_reached"),
        ("publish_not_reached", LOST.format(value="msg", more="        self.p = 1\n"), "publish_not_reached"),
        ("never_finished", STATES.format(asked="Turn"), "state_never_set"),
        ("sides_missing", STATES.format(asked="truning"), "state_never_set"),
        ("never_finished", STATES.format(asked="turning"), "never_finished"),
        ("never_finished", STATES.format(asked="done"), "never_finished"),
        ("turns_too_short", MEASURED.format(condition="abs(err) < 0.02"), "turns_too_short"),
        ("none_in_sum", "self.declare_parameter('side', 2.0)", "none_in_sum"),
        ("turn_too_short", NANOSECONDS.format(limit="d * 1e9"), "turn_too_short"),
        ("turns_too_short", ONE_START.format(count="step", more="msg.angular.z = 1.0"), "turns_too_short"),
        ("turns_too_short", ONE_START.format(count="k = 0\n        self.n", more="pass"), "turns_too_short"),
        ("turns_too_short", ONE_START.format(count="step", more="self.limit += 2.0"), "turns_too_short"),
        ("turns_too_short", ONE_START.format(count="step", more="self.t0 = time.time()"), "turns_too_short"),
        ("no_turns", "node.create_timer(0.1, tick)\nrclpy.spin_once(node)", "spin_once"),
        ("no_turns", "node.create_timer(0.1, tick)\nrclpy.spin_once(node)\nnode.run()", "no_turns"),
        ("too_short", "rclpy.spin_once(node)", "too_short"),
        ("no_turns", "def f():\n    rclpy.spin_once(node)\nwhile True:\n    f()\n", "no_turns"),
        (
            "log_not_reached",
            "class A(Node):\n    def f(self):\n        self.get_logger()\n",
            "class_not_made",
        ),
        ("no_turns", "def f():\n    print(1)\nt = Thread(target=f)\n", "no_turns"),
        ("no_turns", "def f():\n    pub.publish(m)\nt = Thread(target=f)\n", "thread_not_started"),
        ("drives_too_brief", "while t < 2:\n    go()\n    break\n", "leaves_loop"),
        ("drives_too_brief", "while t < 2:\n    if done:\n        break\n", "drives_too_brief"),
        ("drives_too_brief", "while rclpy.ok():\n    run()\n    break\n", "drives_too_brief"),
        ("sides_missing", "for i in t:\n    if i < 1:\n        continue\n    break\n", "sides_missing"),
    ],
)
def test_the_cause_is_told_where_the_script_shows_it(code: str, source: str, wanted: str) -> None:
    assert cause(code, source) == wanted


@pytest.mark.parametrize(
    ("condition", "found"),
    [
        ("n < 4", (1, "n")),
        ("1 > 0", None),  # for ever, and meant so
        ("4 > n", None),
        ("n > 0", None),  # it would have to fall
        ("elapsed < 2.0", None),  # one more is no small step of time
    ],
)
def test_a_counter_is_told_that_one_more_would_bring_to_its_end(
    condition: str, found: tuple[int, str] | None
) -> None:
    source = f"while {condition}:\n    go()\n"
    run = _run(source, "default", RunStatus.INTERRUPTED)
    assert unchanged_counter(run, ScriptText(source)) == found


def test_a_script_of_long_lines_is_not_searched() -> None:
    source = "\n".join(["turn" * 60 + "(" + "movetime" * 30] * 500)
    begun_s = time.process_time()
    assert cause("turns_too_short", source) == "turns_too_short"
    assert time.process_time() - begun_s < 2.0


MANY_TIMERS = "class A(Node):\n    def __init__(self):\n" + "        create_timer(1, tick)\n" * 400
MANY_TIMERS += "    def tick(self):\n" + "        m.angular.z = x\n        m = Twist()\n" * 200


STARTS = "".join(f"        self.t{i} = time.time()\n" for i in range(1, 50))
MANY_STARTS = ONE_START.format(count="n", more="m.linear.x = v").replace(
    "        self.c", STARTS + "        self.c"
)
MANY_STARTS += "".join(f"        p{i} = time.time() - self.t0\n        if p{i} > a{i}:\n" for i in range(440))


@pytest.mark.parametrize(
    "source",
    ["a == 1\n" * 800 + ("if " * 160 + "\n") * 80, MANY_TIMERS, MANY_STARTS],
    ids=["comparisons", "timers", "starts"],
)
def test_many_lines_of_one_kind_are_soon_searched(source: str) -> None:
    begun_s = time.process_time()
    assert cause("no_turns", source) == ("never_sent" if source is MANY_TIMERS else "no_turns")
    assert time.process_time() - begun_s < 5.0


@pytest.mark.parametrize(
    "source",
    [
        "class D(threading.Thread):\n    def run(self):\n        self.pub.publish(m)\nD().start()\n",
        "class N(Node):\n    def go(self):\n        self.pub.publish(m)\ngetattr(N(), 'go')()\n",
        "class N(LifecycleNode):\n    def on_activate(self, state):\n        self.pub.publish(m)\n",
    ],
)
def test_what_others_call_is_not_said_to_be_never_called(source: str) -> None:
    assert cause("never_published", source) == "never_published"


def test_the_first_function_that_nothing_calls_is_told() -> None:
    source = "".join(f"def {name}():\n    pub.publish(m)\n" for name in ("zig", "alpha", "mid", "beta"))
    findings = Findings(measures={}, mistakes=(Mistake("never_published", EMPTY, ()),))
    told = with_causes(assignment("square"), _run(source, "default"), findings).mistakes[0]
    assert (told.code, "zig()" in told.text.en) == ("never_called", True)


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("m.angular.y = 0.5", "other_axis"),
        ("m.angular.x = m.angular.y = 0.0", "no_turns"),
        ("m.linear.x, m.linear.y, m.linear.z = 1.0, 0.0, 0.0", "no_turns"),
        ("ZERO = 0.0\nm.linear.z = ZERO", "no_turns"),
    ],
)
def test_only_a_speed_along_another_axis_is_told(line: str, wanted: str) -> None:
    assert cause("no_turns", line + "\n") == wanted
