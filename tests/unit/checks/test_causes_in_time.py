"""Causes in states, times and ticks, each beside a script that only looks like it."""

from dataclasses import replace

import pytest

from grader.checks.causes import with_causes
from grader.checks.measure import Findings, Measure, Mistake
from grader.contracts.outcome import RunStatus
from grader.contracts.text import EMPTY
from grader.contracts.trajectory import Trajectory
from tests.unit.checks.shipped import assignment
from tests.unit.checks.test_causes import cause
from tests.unit.checks.trajectories import run_of

STATE = (
    "class A(Node):\n    def __init__(self):\n        self.state = 'go'\n    def tick(self):\n"
    "        if self.state == 'go':\n            {change}\n        elif self.state == 'turn':\n"
    "            self.state = 'go'\n"
)
FUNCTION = "def wait(t):\n    {end}\n    while {condition}:\n        {inside}\n    {behind}\nwait(2.0)\n"
NANOSECONDS = (
    "def go(self, t):\n    while (self.now() - start).nanoseconds < {limit}:\n        pub.publish(m)\n"
    "{call}\n"
)
ELAPSED = (
    "class A(Node):\n    def __init__(self):\n        self.create_timer(0.02, self.tick)\n"
    "    def tick(self):\n        now = (self.get_clock().now() - self.start).nanoseconds{divided}\n"
    "        {always}\n        if self.driving:\n            if now >= 2.0:\n"
    "                self.driving = False\n"
    "                {first}\n        else:\n            if now >= 1.57:\n                self.driving = True\n"
    "                self.start = self.get_clock().now()\n"
)
ANEW = "self.start = self.get_clock().now()"
BRANCH = (
    "class A(Node):\n    def __init__(self):\n        self.create_timer(0.02, self.tick)\n    def tick(self):\n"
    "        m = Twist()\n        if self.driving:\n            m.linear.x = 1.0\n"
    "            self.pub.publish(m)\n"
    "        else:\n            m.angular.z = 1.0\n{behind}\n"
)
GIVEN = (
    "def left(self, deg):\n    self.go(1.0, {how})\ndef go(self, w, t):\n    end = time.time() + t\n{call}\n"
)
AMOUNT = "def left(a):\n    go\n    done = 0.0\n    while done < {limit}:\n        done += 0.1\nleft(-1.57)\n"
HEADING = "err = {first} - {second}\nif abs(err) > 0.1:\n    msg.angular.z = {rate}\n"
TURN = "def left(self):\n    self.pub.publish(m)\ndef forward(self):\n    self.pub.publish(m)\nforward()\n{call}\n"


@pytest.mark.parametrize(
    ("code", "source", "wanted"),
    [
        ("side_never_ends", STATE.format(change="self.state == 'turn'"), "compares_for_assigns"),
        ("side_never_ends", STATE.format(change="ok = self.state == 'turn'"), "side_never_ends"),
        ("side_never_ends", STATE.format(change="state = 'turn'"), "kept_local"),
        ("side_never_ends", STATE.format(change="state = 'turn'\n            log(state)"), "side_never_ends"),
        ("side_never_ends", STATE.format(change="self.state = 'turning'"), "state_never_set"),
        ("side_never_ends", STATE.format(change="self.state = 'corner'"), "state_never_set"),
        ("side_never_ends", STATE.format(change="self.state = 'done'"), "side_never_ends"),
        ("only_stops", STATE.replace("'go'", "'Go'", 1).format(change="go()"), "state_never_set"),
        ("no_turns", BRANCH.format(behind=""), "branch_without_publish"),
        ("no_turns", BRANCH.format(behind="        self.pub.publish(m)"), "no_turns"),
        ("no_turns", BRANCH.format(behind="        self.send(m)"), "no_turns"),
        ("no_turns", "for i in range(4):\n    go()\n    continue\n    turn()\n", "skips_rest"),
        ("no_turns", "for i in range(4):\n    go()\n    turn()\n    continue\n", "no_turns"),
        ("no_turns", TURN.format(call=""), "never_called"),
        ("no_turns", TURN.format(call="left()"), "no_turns"),
        ("no_turns", TURN.format(call="left"), "not_called"),
        ("no_turns", TURN.format(call="left()\nforward"), "no_turns"),  # which is called elsewhere
        ("no_turns", GIVEN.format(how="abs(math.radians(deg))", call="left(-90)"), "no_turns"),
        ("no_turns", AMOUNT.format(limit="abs(a)"), "no_turns"),
        ("no_turns", AMOUNT.format(limit="1.0 and a"), "no_turns"),
        ("no_turns", AMOUNT.format(limit="a").replace("go", "a = -a", 1), "no_turns"),
        ("no_turns", GIVEN.format(how="deg // 180 * math.pi", call="left(90)\nleft(270)"), "no_turns"),
        ("turns_too_short", GIVEN.format(how="math.radians(deg)", call="left(90)"), "turns_too_short"),
        ("publish_not_reached", "t = create_timer(0.1, lambda: tick)\ndef tick():\n    go()\n", "not_called"),
        ("publish_not_reached", "create_timer(1, lambda: go())\ndef go():\n    x()\n", "publish_not_reached"),
        ("log_not_reached", "create_timer(10, tick)\ndef tick():\n    log()\n", "long_period"),
        ("log_not_reached", "create_timer(1, tick)\ndef tick():\n    log()\n", "log_not_reached"),
    ],
)  # fmt: skip
def test_states_calls_and_values_that_are_given(code: str, source: str, wanted: str) -> None:
    assert cause(code, source) == wanted


PASSED = "time.time() - start < t"
ONCE = (
    "class A(Node):\n    def __init__(self):\n        self.start = time.time()\n    def go(self, t):\n"
    "        while time.time() - self.start < t{also}:\n            pub.publish(m)\n"
    "    def turn(self, t):\n        while rclpy.ok() and time.time() - self.start < t{also}:\n"
    "            pub.publish(m)\n"
)


@pytest.mark.parametrize(
    ("code", "source", "wanted"),
    [
        ("only_stops", ("end = time.time() + t", "time.time() < end", "pub.publish(m)", ""), "only_stops"),
        ("endless_turn", ("start = time.time()", PASSED, "last = time.time()", ""), "endless_turn"),
        ("endless_turn", ("end = time.time() + t", "end - time.time() < t", "go()", ""), "endless_turn"),
        ("too_brief", ("start = time.time()", PASSED, "pub.publish(m)", "pub.publish(m)"), "too_brief"),
        ("no_turns", ("start = time.time()", PASSED, "go()", ""), "no_turns"),
    ],
)  # fmt: skip
def test_loops_that_wait(code: str, source: tuple[str, str, str, str], wanted: str) -> None:
    end, condition, inside, behind = source
    assert cause(code, FUNCTION.format(end=end, condition=condition, inside=inside, behind=behind)) == wanted


TICKS = (
    "class A(Node):\n    def __init__(self):\n        self.create_timer({period}, self.tick)\n"
    "    def tick(self):\n"
    "        if self.driving:\n            self.n += 1\n            if self.n >= 100:\n                {kept}\n"
    "                self.driving = False\n        else:\n            self.n += 1\n"
    "            if self.n >= {count}:\n"
    "                self.n = 0\n                self.driving = True\n        {behind}\n"
)
LOGGED = "if self.n == 5000:\n            self.get_logger().info('on')"
HELPER = "    def anew(self):\n        self.n = 0\n        self.start = time.time()\n"
LOOP = "for m in plan:\n            pub.publish(m)\n        time.sleep(1)"
RIGHT_SIDES = [(2.0, 1.0, 0.0), (1.0, 0.0, 1.0)] * 4


def _cause(code: str, source: str, motion: Trajectory, corner_deg: float = 60.0, end_s: float = 60.0) -> str:
    run = replace(run_of(motion, RunStatus.INTERRUPTED), source=source)
    run = replace(run, outcome=replace(run.outcome, duration_ns=round(end_s * 1e9)))
    measures = {"corner_deg": Measure(corner_deg)}
    findings = Findings(measures=measures, mistakes=(Mistake(code, EMPTY, ("corner_deg",)),))
    return with_causes(assignment("square"), run, findings).mistakes[0].code


TIMERS = (
    "class A(Node):\n    def __init__(self):\n        self.create_timer(0.1, self.go)\n"
    "        self.create_timer(2.0, self.turn)\n    def go(self):\n        m.linear.x = 1.0\n"
    "        pub.publish(m)\n"
    "    def turn(self):\n        {turned}\n"
)


@pytest.mark.parametrize(
    ("turned", "wanted"),
    [
        ("m.angular.z = 1.57\n        pub.publish(m)", "timers_overrule"),
        ("m.linear.x = 0.0\n        m.angular.z = 1.57\n        pub.publish(m)", "timers_overrule"),
        ("self.turning = True", "turns_too_short"),
        ("m.linear.x = 1.0\n        pub.publish(m)", "turns_too_short"),
        ("if self.turning:\n            m.angular.z = 1.57\n            pub.publish(m)", "turns_too_short"),
        ("m.angular.z = 1.57\n        pub.publish(m)\n        self.t1.cancel()", "turns_too_short"),
    ],
)
def test_two_timers_that_send_commands_of_their_own(turned: str, wanted: str) -> None:
    assert cause("turns_too_short", TIMERS.format(turned=turned)) == wanted
