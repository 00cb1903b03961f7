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
from tests.unit.checks.trajectories import drive, run_of

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
        ("no_turns", GIVEN.format(how="math.radians(deg)", call="left(-90)"), "negative_time"),
        ("no_turns", GIVEN.format(how="abs(math.radians(deg))", call="left(-90)"), "no_turns"),
        ("no_turns", AMOUNT.format(limit="a"), "negative_time"),
        ("no_turns", AMOUNT.format(limit="abs(a)"), "no_turns"),
        ("no_turns", AMOUNT.format(limit="1.0 and a"), "no_turns"),
        ("no_turns", AMOUNT.format(limit="a").replace("go", "a = -a", 1), "no_turns"),
        ("no_turns", GIVEN.format(how="deg // 180 * math.pi", call="left(90)"), "floor_is_zero"),
        ("no_turns", GIVEN.format(how="deg // 180 * math.pi", call="left(90)\nleft(270)"), "no_turns"),
        ("turns_too_short", GIVEN.format(how="math.radians(deg)", call="left(1.5708)"), "radians_twice"),
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
        ("only_stops", ("end = time.time() - t", "time.time() < end", "pub.publish(m)", ""), "ends_in_past"),
        ("only_stops", ("end = time.time() + t", "time.time() < end", "pub.publish(m)", ""), "only_stops"),
        ("only_stops", ("end = time.time() + t", "time.time() > end", "pub.publish(m)", ""), "waits_for_past"),
        ("endless_turn", ("start = time.time()", PASSED, "start = time.time()", ""), "start_anew"),
        ("endless_turn", ("start = time.time()", PASSED, "last = time.time()", ""), "endless_turn"),
        ("endless_turn", ("start = time.time()", "start - time.time() < t", "go()", ""), "reversed_time"),
        ("endless_turn", ("end = time.time() + t", "end - time.time() < t", "go()", ""), "endless_turn"),
        ("too_brief", ("start = time.time()", PASSED, "time.sleep(0.1)", "pub.publish(m)"), "publish_behind_loop"),
        ("too_brief", ("start = time.time()", PASSED, "pub.publish(m)", "pub.publish(m)"), "too_brief"),
        ("no_turns", ("start = time.time()", PASSED, "go()", ""), "no_turns"),
    ],
)  # fmt: skip
def test_loops_that_wait(code: str, source: tuple[str, str, str, str], wanted: str) -> None:
    end, condition, inside, behind = source
    assert cause(code, FUNCTION.format(end=end, condition=condition, inside=inside, behind=behind)) == wanted


def test_a_start_time_of_the_module_is_that_of_each_motion() -> None:
    waits = (
        "def go(t):\n    {own}\n    while time.time() - start < t:\n        pub.publish(m)\n"
        "start = time.time()\n"
    )
    assert cause("no_turns", waits.format(own="m = Twist()")) == "start_once"
    assert cause("no_turns", waits.format(own="start = time.time()")) == "no_turns"
    called = waits.format(own="m = Twist()") + "go(2.0)\n"
    assert cause("no_turns", called) == "no_turns"  # one loop, which may be the whole drive
    assert cause("no_turns", called + "go(1.0)\n") == "start_once"


@pytest.mark.parametrize(
    ("also", "wanted"),
    [("", "start_once"), (" and rclpy.ok()", "start_once"), (" and n < 4", "sides_missing")],
)
def test_a_limit_beside_another_condition_may_be_that_of_the_whole_run(also: str, wanted: str) -> None:
    assert cause("sides_missing", ONCE.format(also=also)) == wanted


@pytest.mark.parametrize(
    ("limit", "call", "wanted"),
    [
        ("t", "node.go(2.0)", "nanoseconds_unit"),
        ("t * 1e6", "node.go(2.0)", "nanoseconds_unit"),
        ("t * 1000000", "node.go(2.0)", "nanoseconds_unit"),
        ("2", "", "nanoseconds_unit"),
        ("t * 1e9", "node.go(2.0)", "no_turns"),
        ("t", "node.go(2.0 * 1e9)", "no_turns"),
        ("t_ns", "node.go(2.0)", "no_turns"),
        ("2e9", "", "no_turns"),
        ("2_000_000_000", "", "no_turns"),
        ("end", "def f():\n    end = node.now().nanoseconds + int(t * 1e9)", "no_turns"),
    ],
)
def test_nanoseconds_are_compared_with_nanoseconds(limit: str, call: str, wanted: str) -> None:
    assert cause("no_turns", NANOSECONDS.format(limit=limit, call=call)) == wanted


@pytest.mark.parametrize(
    ("code", "divided", "always", "first", "wanted"),
    [
        ("drives_too_brief", "", "pass", ANEW, "not_seconds"),
        ("drives_too_brief", " / 1e6", "pass", ANEW, "not_seconds"),
        ("drives_too_brief", " / 1e9", "pass", ANEW, "drives_too_brief"),
        ("turns_too_short", " / 1e9", "pass", "pass", "start_kept"),
        ("turns_too_short", " / 1e9", "pass", ANEW, "turns_too_short"),
        ("side_never_ends", " / 1e9", ANEW, ANEW, "start_anew_each_tick"),
        ("side_never_ends", " / 1e9", f"self.way += now\n        {ANEW}", ANEW, "side_never_ends"),
        ("side_never_ends", " / 1e9", f"self.left -= now\n        {ANEW}", ANEW, "side_never_ends"),
        ("side_never_ends", " / 1e9", f"d = (err - self.err) / now\n        {ANEW}", ANEW, "side_never_ends"),
    ],
)
def test_the_time_that_has_passed(code: str, divided: str, always: str, first: str, wanted: str) -> None:
    assert cause(code, ELAPSED.format(divided=divided, always=always, first=first)) == wanted


@pytest.mark.parametrize(
    ("first", "second", "rate", "wanted"),
    [
        ("self.pose.theta", "target", "2.0 * err", "turns_away"),
        ("target", "self.pose.theta", "-2.0 * err", "turns_away"),
        ("self.pose.theta", "math.atan2(dy, dx)", "1.0 if err > 0 else -1.0", "turns_away"),
        ("target", "self.pose.theta", "2.0 * err", "swings"),
        ("self.pose.theta", "target", "-2.0 * err", "swings"),
        ("target_theta", "self.pose.theta", "2.0 * err", "swings"),
        ("self.pose.theta", "target", "limit(err)", "swings"),
        ("self.pose.theta", "self.start_theta", "2.0 * turned", "swings"),
    ],
)
def test_an_error_with_the_wrong_sign_turns_the_car_away(
    first: str, second: str, rate: str, wanted: str
) -> None:
    assert cause("swings", HEADING.format(first=first, second=second, rate=rate)) == wanted


@pytest.mark.parametrize(
    ("source", "wanted"),
    [
        ("dy = self.pose.y - gy\ndx = gx - self.pose.x\na = math.atan2(dy, dx)", "away_from_goal"),
        ("dy = self.pose.y - gy\ndx = self.pose.x - gx\na = math.atan2(-dy, -dx)", "place_away"),
        ("a = math.degrees(math.atan2(dy, dx))\ne = a - self.pose.theta", "degrees_of_radians"),
        ("a = math.degrees(math.atan2(dy, dx))\ne = a - math.degrees(self.pose.theta)", "place_away"),
    ],
)
def test_directions_to_a_goal(source: str, wanted: str) -> None:
    assert cause("place_away", source) == wanted


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


@pytest.mark.parametrize(
    ("code", "changes", "wanted"),
    [
        ("turns_too_short", {"kept": "pass"}, "count_not_reset"),
        ("turns_too_short", {"kept": "self.anew()", "behind": "pass\n" + HELPER}, "turns_too_short"),
        ("turns_too_short", {"kept": "pass", "count": "160"}, "turns_too_short"),  # 60 ticks after the 100
        ("turns_too_short", {"kept": "pass", "period": "0.05"}, "turns_too_short"),  # no motion lasted for 5 s
        ("turns_too_short", {}, "turns_too_short"),  # 50 ticks of 0.02 s, not 50 s
        ("turns_too_short", {"count": "2", "period": "0.5"}, "counts_ticks"),
        ("side_never_ends", {"period": "1.0"}, "ticks_too_long"),
        ("side_never_ends", {"period": "1.0", "kept": "raise SystemExit"}, "side_never_ends"),
        ("side_never_ends", {"period": "0.1"}, "side_never_ends"),
        ("side_never_ends", {"period": "0.1", "behind": LOGGED}, "side_never_ends"),
        ("side_never_ends", {"behind": "time.sleep(1.0)"}, "sleeps_in_callback"),
        ("side_never_ends", {"behind": "time.sleep(0.01)"}, "side_never_ends"),
        ("side_never_ends", {"behind": LOOP}, "side_never_ends"),
    ],
)  # fmt: skip
def test_counts_of_ticks(code: str, changes: dict[str, str], wanted: str) -> None:
    source = TICKS.format(**{"period": "0.02", "kept": "self.n = 0", "count": "50", "behind": "", **changes})
    assert _cause(code, source, drive(RIGHT_SIDES)) == wanted


def test_a_sum_that_is_never_set_back_is_told_and_no_number_of_sides() -> None:
    source = (
        "class A(Node):\n    def __init__(self):\n        self.t = 0.0\n"
        "        self.create_timer(0.02, self.tick)\n"
        "    def tick(self):\n        self.t += {step}\n        if self.t >= limit:\n"
        "            self.step += 1\n{back}"
    )
    assert cause("sides_missing", source.format(step="0.02", back="")) == "sum_not_reset"
    assert cause("sides_missing", source.format(step="1", back="")) == "sides_missing"
    back = "            self.t = 0.0\n"
    assert cause("sides_missing", source.format(step="0.02", back=back)) == "sides_missing"
    since = "        way = self.t - self.begin\n"
    assert cause("sides_missing", source.format(step="0.02", back=since)) == "sides_missing"
    moved = "            self.limit += 2.0\n"
    source = source.replace("limit", "self.limit")
    assert cause("sides_missing", source.format(step="0.02", back=moved)) == "sides_missing"


def test_instants_on_one_scale_are_no_sums_to_be_set_back() -> None:
    begin = (
        "class A(Node):\n    def __init__(self):\n        self.t = 0.0\n"
        "        self.create_timer(0.02, self.tick)\n    def tick(self):\n        self.t += 0.02\n"
    )
    branches = [f"        if self.t >= {at}:\n            self.step = {at}\n" for at in (2.0, 3.57, 5.57)]
    assert cause("unequal_sides", begin + "".join(branches)) == "unequal_sides"
    assert cause("unequal_sides", begin + "".join(branches[:2])) == "sum_not_reset"


def test_a_start_time_is_kept_only_where_nothing_takes_it_anew() -> None:
    by_helper = ELAPSED.format(divided=" / 1e9", always="pass", first="self.anew()") + HELPER
    assert cause("turns_too_short", by_helper) == "turns_too_short"
    source = ELAPSED.format(divided=" / 1e9", always="pass", first=ANEW)
    guard = "        if time.time() - self.begun >= 40.0:\n            self.done = True\n"
    assert (
        cause("turns_too_short", source.replace("        if self.driving", f"{guard}        if self.driving"))
        == "turns_too_short"
    )


@pytest.mark.parametrize(("corner_deg", "wanted"), [(101.0, "no_stop_between"), (120.0, "turns_too_far")])
def test_a_pause_without_a_stop_lengthens_the_turn_by_as_much(corner_deg: float, wanted: str) -> None:
    held = drive([(2.0, 1.0, 0.0), (1.57, 0.0, 1.0), (0.2, 0.0, 0.0)] * 4)
    first_stops = {
        after.t_ns
        for before, after in zip(held.commands, held.commands[1:], strict=False)
        if before.w_radps and not after.w_radps
    }
    moves = tuple(one for one in held.commands if one.v_mps or one.w_radps)
    assert first_stops
    changed = Trajectory(
        **{**{name: getattr(held, name) for name in Trajectory.__slots__}, "commands": moves}
    )
    assert _cause("turns_too_far", "pub.publish(m)", changed, corner_deg) == wanted


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
