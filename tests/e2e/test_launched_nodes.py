"""Several nodes of a student's own in one launch: each as if it had a process of its own, in one run."""

import os

import pytest

from grader.contracts.assignment import WantedPackage
from grader.contracts.grading import GradingJob
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.report import GradeReport
from grader.formats.packages.bundle import bundled
from grader.grading.slot import Slot
from tests.e2e.test_packages import assignment
from tests.fakes.packages import NAME, SETUP, package_files, zipped

LAUNCH = """from launch import LaunchDescription
from launch.actions import TimerAction
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([{nodes}])
"""
PAIR = """
    Node(package='my_turtle', executable='ask', name='boss', namespace='team', parameters=[{'speed': 0.5}],
         remappings=[('wish', 'order')], arguments=['--loud']),
    Node(package='my_turtle', executable='drive', name='wheels', namespace='team',
         parameters=[{'speed': 2.0}], remappings=[('cmd', '/turtle1/cmd_vel')]),
"""
SHARED = "import rclpy\nseen = []\n"
ASK = """import sys
import rclpy
from std_msgs.msg import Float64
from rclpy.node import Node
from my_turtle import shared

class Ask(Node):
    def __init__(self):
        super().__init__('ask')
        self.pub = self.create_publisher(Float64, 'wish', 10)
        self.speed = self.declare_parameter('speed', 0.0).value
        self.create_timer(0.1, self.tick)
    def tick(self):
        shared.seen.append(1)
        self.pub.publish(Float64(data=self.speed))

def main():
    rclpy.init()
    node = Ask()
    print('ask', __name__, sys.argv[0].rpartition('/')[2], sys.argv[1], node.get_fully_qualified_name())
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print('ask', len(shared.seen) > 50, rclpy.ok(), sorted(set(shared.seen)))
"""
DRIVE = """import sys
import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64
from rclpy.node import Node
from my_turtle import shared

class Drive(Node):
    def __init__(self):
        super().__init__('drive')
        self.pub = self.create_publisher(Twist, 'cmd', 10)
        self.most = self.declare_parameter('speed', 0.0).value
        self.create_subscription(Float64, 'order', self.on_order, 10)
    def on_order(self, wish):
        shared.seen.append(2)
        msg = Twist()
        msg.linear.x = min(wish.data, self.most)
        self.pub.publish(msg)

def main():
    rclpy.init()
    node = Drive()
    print('drive', sys.argv[0].rpartition('/')[2], node.get_fully_qualified_name(), node.most)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print('drive', rclpy.ok(), sorted(set(shared.seen)))
        sys.exit(3)
"""


def _entry(name: str) -> str:
    return f"'{name} = my_turtle.{name}:main', " if name != "drive" else ""


def launched(slot: Slot, nodes: str = PAIR, **changed: str) -> GradeReport:
    return launched_as(slot, LAUNCH.replace("{nodes}", nodes), **changed)


def launched_as(slot: Slot, launch: str, kind: str = "py", **changed: str) -> GradeReport:
    setup = SETUP.format(name=NAME).replace(
        "'drive = my_turtle.drive:main',",
        f"'drive = my_turtle.drive:main', {''.join(_entry(each) for each in ('ask', *changed))}",
    )
    own = {"shared": SHARED, "ask": ASK, "drive": DRIVE, **changed}
    modules = {f"{NAME}/{name}.py": text for name, text in own.items()}
    setup = setup.replace("launch/*.launch.py", f"launch/*.launch.{kind}")
    files = package_files(**{"setup.py": setup, f"launch/both.launch.{kind}": launch, **modules})
    job = GradingJob(
        file_name="p.zip",
        source=bundled(zipped(files)),
        assignment=assignment(WantedPackage(launch=f"both.launch.{kind}")),
    )
    return slot.grade(job).report


def of(report: GradeReport) -> RunOutcome:
    return report.runs[0].outcome


def test_two_nodes_meet_in_the_graph_alone(slot: Slot) -> None:
    report = launched(slot)
    outcome = of(report)
    lines = outcome.stdout.text.splitlines()
    assert lines[:2] == ["ask my_turtle.ask ask --loud /team/boss", "drive drive /team/wheels 2.0"]
    assert sorted(lines[2:]) == ["ask True False [1]", "drive False [2]"]  # each its own Ctrl+C
    assert (report.score, outcome.status, outcome.exit_code) == (100, RunStatus.INTERRUPTED, 3)
    assert (outcome.notes[0].code, outcome.notes[0].text) == (
        "launch_several",
        "my_turtle/ask, my_turtle/drive",
    )


XML = """<launch>
  <arg name="most" default="2.0" description="of the wheels"/>
  <let name="team" value="team"/>
  <group>
    <push-ros-namespace namespace="$(var team)"/>
    <node pkg="my_turtle" exec="ask" name="boss" args="--loud">
      <param name="speed" value="0.5"/>
      <remap from="wish" to="order"/>
    </node>
    <node pkg="my_turtle" exec="drive" name="wheels" if="true">
      <param name="speed" value="$(var most)"/>
      <remap from="cmd" to="/turtle1/cmd_vel"/>
    </node>
    <node pkg="my_turtle" exec="drive" unless="true"/>
  </group>
</launch>
"""
IN_YAML = """launch:
- arg:
    name: most
    default: "2.0"
- group:
    - push_ros_namespace:
        namespace: team
    - node:
        pkg: my_turtle
        exec: ask
        name: boss
        args: --loud
        param:
        - name: speed
          value: 0.5
        remap:
        - from: wish
          to: order
    - node:
        pkg: my_turtle
        exec: drive
        name: wheels
        param:
        - name: speed
          value: $(var most)
        remap:
        - from: cmd
          to: /turtle1/cmd_vel
"""


@pytest.mark.parametrize(("kind", "launch"), [("xml", XML), ("yaml", IN_YAML)])
def test_a_launch_file_in_xml_or_yaml_starts_the_same_nodes(slot: Slot, kind: str, launch: str) -> None:
    report, in_python = launched_as(slot, launch, kind), launched(slot)
    assert of(report).stdout == of(in_python).stdout
    assert (report.score, report.items) == (100, in_python.items)


@pytest.mark.parametrize(
    ("kind", "launch", "said"),
    [
        ("xml", "<launch><node></launch>", "syntax error"),
        ("xml", "<launch><node pkg='my_turtle'/></launch>", "Attribute 'exec' of Entity 'node' not found"),
        ("xml", "<launch><nodes/></launch>", "Unrecognized entity of the type: nodes"),
        ("yaml", "- node", "Expected only one root"),
        ("yaml", "launch: [node: {pkg: my_turtle", "syntax error"),
    ],
)
def test_what_is_wrong_with_a_launch_file_in_xml_or_yaml_is_told(
    slot: Slot, kind: str, launch: str, said: str
) -> None:
    outcome = of(launched_as(slot, launch, kind))
    assert outcome.status is RunStatus.CRASHED
    assert outcome.error is not None
    assert said in outcome.error.message


def test_it_is_the_same_run_again_and_again(slot: Slot) -> None:
    assert len({launched(slot).sha256() for _ in range(int(os.environ.get("RUNS", "3")))}) == 1


DIES = """import atexit, threading, time
import rclpy
from std_srvs.srv import Trigger
from std_msgs.msg import Float64

def forever(pub):
    while True:
        pub.publish(Float64(data=9.0))
        time.sleep(0.1)

def main():
    rclpy.init()
    node = rclpy.create_node('asker')
    node.create_service(Trigger, '/help', lambda request, response: response)
    pub = node.create_publisher(Float64, '/team/order', 10)
    threading.Thread(target=forever, args=(pub,), daemon=True).start()
    end = time.monotonic() + 1.05
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)
    {end}
"""
WATCHES = """import threading
import rclpy
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

def main():
    rclpy.init()
    node = rclpy.create_node('watch')
    heard = []
    node.create_subscription(Float64, '/team/order', heard.append, 10)
    client = node.create_client(Trigger, '/help')
    there = client.wait_for_service(5.0)
    while node.count_publishers('/team/order'):
        rclpy.spin_once(node, timeout_sec=0.5)
    print(there, client.service_is_ready(), len(heard), node.get_node_names(), rclpy.ok())
    print(threading.current_thread().name, threading.current_thread() is threading.main_thread())
    rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("end", "told"),
    [
        ("raise ValueError('tired')", ("crashed", 1, "ValueError: tired")),
        ("import sys; sys.exit(4)", ("interrupted", 4, "")),
        ("import os; os._exit(5)", ("interrupted", 5, "")),
        ("threading.Thread(target=lambda: __import__('os')._exit(6)).start(); rclpy.spin(node)",
         ("interrupted", 6, "")),
        ("pass", ("interrupted", 130, "")),
    ],
    ids=["raises", "exits", "ends at once", "is ended by a thread of its own", "returns"],
)  # fmt: skip
def test_a_node_that_ends_takes_its_own_things_along_and_no_other(
    slot: Slot, end: str, told: tuple[str, int, str]
) -> None:
    report = launched(slot, ask=DIES.replace("{end}", end), drive=WATCHES)
    outcome = of(report)
    lines = outcome.stdout.text.splitlines()
    assert lines[0].startswith("True False 1"), outcome.stderr.text
    assert int(lines[0].split()[2]) in (
        11,
        12,
    )  # one each 0.1 s until 1.1 s, no more of a thread that lives on
    assert lines[0].endswith("['gazebo'] True") or "['turtlesim', 'wheels'] True" in lines[0]
    assert lines[1] == "MainThread True"
    assert (outcome.status, outcome.exit_code) == told[:2]
    assert told[2] in outcome.stderr.text
    assert "KeyboardInterrupt" in outcome.stderr.text  # the other one's, at the horizon
    if outcome.error is not None:
        assert (outcome.error.file, outcome.error.message) == (f"{NAME}/{NAME}/ask.py", "tired")


HANDLES = """import signal, sys, time
import rclpy

def main():
    rclpy.init()
    node = rclpy.create_node('a')
    signal.signal(signal.SIGINT, lambda number, frame: print('{name}', 'signal', rclpy.ok()))
    deep = lambda n: n and deep(n - 1) or node.get_clock().now()
    for depth in range(900, 1100):
        try:
            deep(depth)
        except RecursionError:
            time.sleep(0.001)
    print('{name}', sys.argv[0].rpartition('/')[2])
    time.sleep(60.0)
    print('{name}', 'slept')
"""


def test_each_has_a_handler_of_its_own_and_sleeps_on_after_it(slot: Slot) -> None:
    report = launched(slot, ask=HANDLES.replace("{name}", "ask"), drive=HANDLES.replace("{name}", "drive"))
    lines = of(report).stdout.text.splitlines()
    assert sorted(lines[:2]) == ["ask ask", "drive drive"], of(report).stderr.text
    assert lines.count("ask signal True") == lines.count("drive signal True") >= 1
    assert "ask slept" not in lines  # the horizon's end comes first


def test_one_that_waits_for_a_delay_begins_later(slot: Slot) -> None:
    first, second = PAIR.strip().split("\n    Node(")
    later = f"{first} TimerAction(period=2.0, actions=[Node({second.rstrip(',')}])"
    outcome = of(launched(slot, later))
    assert outcome.first_command_ns is not None, outcome.stderr.text
    assert 2_000_000_000 < outcome.first_command_ns < 2_200_000_000


def test_one_whose_time_does_not_come_has_never_been_started(slot: Slot) -> None:
    late = "TimerAction(period=500.0, actions=[Node(package='my_turtle', executable='ask', arguments=['late'])]),"
    outcome = of(launched(slot, PAIR + late))
    assert outcome.stdout.text.count("ask my_turtle.ask") == 1
    assert (outcome.stderr.text, outcome.status) == ("", RunStatus.INTERRUPTED)


LISTENS = """import rclpy
from std_msgs.msg import Float64

def main():
    rclpy.init()
    node = rclpy.create_node('listens')
    node.create_subscription(Float64, '/team/order', print, 10)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print('listened')
"""


@pytest.mark.parametrize(
    "end", ["raise ValueError('tired')", "import os, time; time.sleep(1.0); os._exit(1)"]
)
def test_one_that_ended_before_a_long_silence_is_told_and_the_other_gets_its_interrupt(
    slot: Slot, end: str
) -> None:
    ask = f"def main():\n    {end}\n"
    outcome = of(launched(slot, ask=ask, drive=LISTENS))
    assert (outcome.stdout.text, outcome.exit_code) == ("listened\n", 1), outcome.stderr.text
    assert (outcome.error is not None) == ("raise" in end)


def test_two_of_one_module_that_spins_while_it_is_loaded(slot: Slot) -> None:
    drive = "import rclpy\nrclpy.init()\nnode = rclpy.create_node('a')\nprint(node.get_name())\nrclpy.spin(node)\n"
    twice = """
    Node(package='my_turtle', executable='drive', name='one'),
    Node(package='my_turtle', executable='drive', name='two'),
"""
    outcome = of(launched(slot, twice, drive=drive))
    assert sorted(outcome.stdout.text.split()) == ["one", "two"], outcome.stderr.text


SAYS = """import sys, time
import rclpy

def main():
    rclpy.init()
    print(sys.argv[1], round(rclpy.create_node('a').get_clock().now().nanoseconds / 1e9 % 1000, 1))
    time.sleep(1.0)
    {end}
"""
CHAIN = """from launch import LaunchDescription
from launch.actions import LogInfo, RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessExit, OnProcessStart
from launch_ros.actions import Node

def ended(event, context):
    return [LogInfo(msg=f'ended with {event.returncode}'), last]

first = Node(package='my_turtle', executable='ask', arguments=['first'])
second = Node(package='my_turtle', executable='ask', arguments=['second'])
last = Node(package='my_turtle', executable='drive', on_exit=[LogInfo(msg='all done')])

def generate_launch_description():
    return LaunchDescription([
        RegisterEventHandler(OnProcessExit(
            target_action=first, on_exit=[TimerAction(period=2.0, actions=[second]), LogInfo(msg='next')]
        )),
        RegisterEventHandler(OnProcessExit(target_action=second, on_exit=ended)),
        RegisterEventHandler(OnProcessStart(target_action=last, on_start=[LogInfo(msg='the last')])),
        first,
    ])
"""
LAST = """import rclpy
from geometry_msgs.msg import Twist

def main():
    rclpy.init()
    node = rclpy.create_node('last')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    msg = Twist()
    msg.linear.x = 1.0
    for _ in range(20):
        pub.publish(msg)
        rclpy.spin_once(node, timeout_sec=0.05)
"""


@pytest.mark.parametrize(
    ("end", "code"),
    [
        ("pass", 0),
        ("sys.exit(3)", 3),
        ("import os; sys.stdout.flush(); os._exit(4)", 4),
        ("raise ValueError", 1),
    ],
)
def test_nodes_start_when_others_have_ended(slot: Slot, end: str, code: int) -> None:
    report = launched_as(slot, CHAIN, ask=SAYS.replace("{end}", end), drive=LAST)
    outcome = of(report)
    lines = outcome.stdout.text.splitlines()
    assert [line.split()[0] for line in lines[:1]] == ["first"], outcome.stderr.text
    begun = [float(line.split()[1]) for line in (lines[0], lines[2])]
    assert begun[1] - begun[0] == pytest.approx(3.0, abs=0.2)
    assert (lines[1], lines[2].split()[0]) == ("[INFO] [launch.user]: next", "second")
    assert lines[3:] == [
        f"[INFO] [launch.user]: {words}" for words in (f"ended with {code}", "the last", "all done")
    ]
    assert outcome.first_command_ns is not None
    assert 4_000_000_000 < outcome.first_command_ns < 4_500_000_000
    assert [note.text for note in outcome.notes if note.code == "launch_ignored"] == []
    assert report.score == 100 or outcome.status is RunStatus.CRASHED


def test_a_node_that_ends_at_ctrl_c_is_followed_by_none(slot: Slot) -> None:
    spins = "import rclpy\n\ndef main():\n    rclpy.init()\n    rclpy.spin(rclpy.create_node('a'))\n"
    outcome = of(launched_as(slot, CHAIN, ask=spins, drive=LAST))
    assert (outcome.stdout.text, outcome.first_command_ns) == ("", None)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("on_exit=ended", "on_exit=[first]", "executed more than once"),
        ("executable='drive'", "executable='dirve'", "executable 'dirve' not found"),
    ],
)
def test_what_cannot_start_after_another_is_told(slot: Slot, old: str, new: str, said: str) -> None:
    outcome = of(launched_as(slot, CHAIN.replace(old, new), ask=SAYS.replace("{end}", "pass"), drive=LAST))
    assert (outcome.status, said in outcome.stderr.text) == (RunStatus.CRASHED, True), outcome.stderr.text


POOL = """import rclpy, time
from concurrent.futures import ThreadPoolExecutor
from std_msgs.msg import Float64

pool = ThreadPoolExecutor(2)

def main():
    rclpy.init()
    pub = rclpy.create_node('short').create_publisher(Float64, '/team/order', 10)
    pool.submit(lambda: [(pub.publish(Float64()), time.sleep(0.1)) for _ in range(10)])
"""


def test_a_node_ends_whose_pool_of_threads_has_nothing_more_to_do(slot: Slot) -> None:
    outcome = of(launched(slot, ask=POOL, drive=WATCHES.replace("rclpy.spin(node)", "return 7")))
    assert (outcome.status, outcome.exit_code) == (RunStatus.FINISHED, 7), outcome.stderr.text


def test_a_node_that_leaves_a_dead_proxy_behind_takes_its_things_along(slot: Slot) -> None:
    proxy = "proxies.append(__import__('weakref').proxy(type('Gone', (), {})()))"
    ask = DIES.replace("{end}", proxy).replace("def forever", "proxies = []\n\ndef forever")
    outcome = of(launched(slot, ask=ask, drive=WATCHES))
    assert outcome.stdout.text.startswith("True False 1"), outcome.stderr.text
    assert "ReferenceError" not in outcome.stderr.text


MANY = "*[Node(package='my_turtle', executable='ask', arguments=['x'], name=f'n{i}') for i in range({})]"


@pytest.mark.slow
def test_as_many_nodes_as_there_are_threads_run(slot: Slot) -> None:
    assert of(launched(slot, MANY.replace("{}", "63"))).stdout.text.count("ask my_turtle.ask") == 63


def test_more_nodes_than_threads_are_refused_before_one_is_started(slot: Slot) -> None:
    outcome = of(launched(slot, MANY.replace("{}", "64")))
    assert (outcome.status, outcome.stdout.text) == (RunStatus.CRASHED, "")
    assert "64 nodes of your own, of which 63 can run at once" in outcome.stderr.text


@pytest.mark.parametrize(
    ("old", "new", "code", "words"),
    [
        ("('wish', 'order')", "('wish', 'orders')", "topic_nowhere", "What is published: /team/orders,"),
        (
            "name='boss', namespace='team'",
            "name='boss', namespace='crew'",
            "topic_nowhere",
            "What is published: /crew/order,",
        ),
        ("'drive', name='wheels'", "'idle', name='wheels'", "never_published", "never called publish()"),
        ("'ask', name='boss'", "'shouts', name='boss'", "types_differ", "as std_msgs/msg/String"),
    ],
)
def test_the_hint_says_what_keeps_two_nodes_apart(
    slot: Slot, old: str, new: str, code: str, words: str
) -> None:
    assert old in PAIR
    idle = DRIVE.replace("rclpy.spin(node)", "__import__('time').sleep(100)")
    shouts = ASK.replace("Float64(data=self.speed)", "String(data='go')").replace("Float64", "String")
    report = launched(slot, PAIR.replace(old, new), idle=idle, shouts=shouts)
    assert (report.mistakes[0], words in report.hint.en) == (code, True), report.hint.en
    assert report.score == 0


def test_a_topic_between_own_nodes_is_not_called_a_wrong_one(slot: Slot) -> None:
    report = launched(slot, drive=DRIVE.replace("Twist, 'cmd'", "Twist, '/turtle2/cmd_vel'"), ask=ASK)
    assert report.mistakes[0] == "wrong_topic"
    assert "/turtle2/cmd_vel" in report.hint.en
    assert "/team/order" not in report.hint.en


def test_a_client_without_its_service_is_told_before_the_stops_of_another_node(slot: Slot) -> None:
    asks = """import rclpy
from std_srvs.srv import Trigger

def main():
    rclpy.init()
    node = rclpy.create_node('asks')
    node.create_client(Trigger, 'engine').wait_for_service()
"""
    drive = DRIVE.replace("self.create_subscription", "self.create_timer(0.1, lambda: self.pub.publish(Twist()))\n"
                          "        self.create_subscription")  # fmt: skip
    report = launched(slot, ask=asks, drive=drive)
    assert (report.mistakes[0], "/team/engine" in report.hint.en) == ("service_nowhere", True), report.hint.en


ENDS = """import rclpy

def main():
    rclpy.init()
    rclpy.create_node('ends')
"""
WHERE = """import os
import rclpy

def main():
    rclpy.init()
    rclpy.create_node('where')
    print(os.environ.get('MINE'), os.getcwd(), os.environ.get('ROS_DISTRO'))
    os.environ['MINE'] = 'changed'
"""


@pytest.mark.parametrize("again", [False, True], ids=["one node", "two nodes"])
def test_each_node_has_its_environment_and_folder(slot: Slot, again: bool) -> None:
    nodes = """
    SetEnvironmentVariable('MINE', 'all'),
    Node(package='my_turtle', executable='ask', additional_env={'MINE': 'a'}, cwd='/tmp'),
"""
    if again:
        nodes += """
    Node(package='my_turtle', executable='ask', env={'MINE': 'b'}),
    Node(package='my_turtle', executable='ask'),
"""
    launch = LAUNCH.replace("{nodes}", nodes).replace("TimerAction", "SetEnvironmentVariable")
    outcome = of(launched_as(slot, launch, ask=WHERE))
    first, *others = outcome.stdout.text.splitlines()
    assert first == "a /tmp humble", outcome.stderr.text
    assert [line.split()[::2] for line in others] == [["b", "None"], ["all", "humble"]][: 2 * again]
    assert all(line.split()[1] != "/tmp" for line in others)


DOWN = """from launch import LaunchDescription
from launch.actions import EmitEvent, LogInfo, RegisterEventHandler, Shutdown as End, TimerAction
from launch.event_handlers import OnProcessExit, OnShutdown
from launch.events import Shutdown
from launch.substitutions import LocalSubstitution
from launch_ros.actions import Node

def generate_launch_description():
    ask = Node(package='my_turtle', executable='ask'{more})
    return LaunchDescription([
        RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg=['down: ', LocalSubstitution('event.reason')])])),
        Node(package='my_turtle', executable='drive', remappings=[('cmd', '/turtle1/cmd_vel')]),
        ask, {also}
    ])
"""
FAST = DRIVE.replace(
    "        self.create_subs", "        self.create_timer(0.1, self.go)\n        self.create_subs"
).replace("    def on_order", "    def go(self):\n        self.pub.publish(Twist())\n    def on_order")


@pytest.mark.parametrize(
    ("more", "also", "reason", "after_s"),
    [
        (", on_exit=End(reason='done')", "", "done", 1.0),
        (
            "",
            "RegisterEventHandler(OnProcessExit(target_action=ask, on_exit=[EmitEvent(event=Shutdown())])),",
            "reason not given",
            1.0,
        ),
        ("", "TimerAction(period=3.0, actions=[End(reason='late')]),", "late", 3.0),
        ("", "", "ctrl-c (SIGINT)", 60.0),
    ],
    ids=["on_exit", "event", "timer", "never"],
)
def test_a_launch_file_ends_everything(slot: Slot, more: str, also: str, reason: str, after_s: float) -> None:
    launch = DOWN.replace("{more}", more).replace("{also}", also)
    ask = ENDS.replace(
        "    rclpy.create_node('ends')", "    rclpy.create_node('ends')\n    __import__('time').sleep(1.0)"
    )
    report = launched_as(slot, launch, ask=ask, drive=FAST)
    outcome = of(report)
    assert f"[INFO] [launch.user]: down: {reason}\n" in outcome.stdout.text, outcome.stderr.text
    assert outcome.stdout.text.count("down: ") == 1
    assert "drive False" in outcome.stdout.text  # its own Ctrl+C
    assert outcome.status is (RunStatus.INTERRUPTED if after_s > 3.0 else RunStatus.FINISHED)
    assert outcome.last_command_ns is not None
    longest_s = min(after_s, assignment(WantedPackage()).horizon_s)
    assert outcome.last_command_ns / 1e9 == pytest.approx(longest_s, abs=0.25)


def test_a_node_that_lets_ctrl_c_through_is_no_crash_when_the_launch_file_ends_it(slot: Slot) -> None:
    launch = DOWN.replace("{more}", ", on_exit=End()").replace("{also}", "")
    spins = FAST[: FAST.index("    try:")] + "    rclpy.spin(node)\n"
    report = launched_as(slot, launch, ask=ENDS, drive=spins)
    outcome = of(report)
    assert (outcome.status, outcome.exit_code, outcome.error) == (RunStatus.FINISHED, 130, None)
    assert "KeyboardInterrupt" in outcome.stderr.text


def test_a_launch_whose_nodes_have_all_ended_is_over(slot: Slot) -> None:
    launch = DOWN.replace("{more}", "").replace("{also}", "")
    outcome = of(launched_as(slot, launch, ask=ENDS, drive=ENDS))
    assert "down: idle" in outcome.stdout.text, outcome.stderr.text
    assert outcome.status is RunStatus.FINISHED


@pytest.mark.parametrize("name", ["my_turtel", "My_Turtle", "my-turtle"])
def test_a_misspelt_package_of_ones_own_is_not_found(slot: Slot, name: str) -> None:
    report = launched(
        slot, PAIR.replace("package='my_turtle', executable='ask'", f"package='{name}', executable='ask'")
    )
    outcome = of(report)
    assert outcome.status is RunStatus.CRASHED
    assert (
        f"package '{name}' not found" in outcome.stderr.text
        or f"'{name}' is not a valid" in outcome.stderr.text
    )
    assert report.mistakes[0] == "unknown_package"
    assert f"no package {name}." in report.hint.en
    assert name in report.hint.zh


def test_a_package_of_others_is_left_out_with_a_note(slot: Slot) -> None:
    outcome = of(launched(slot, "Node(package='rviz2', executable='rviz2')," + PAIR))
    assert ("launch_ignored", "rviz2 rviz2") in [(note.code, note.text) for note in outcome.notes]
    assert outcome.status is RunStatus.INTERRUPTED


TUTORIAL = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, ExecuteProcess, LogInfo, RegisterEventHandler
from launch.actions import TimerAction
from launch.conditions import IfCondition
from launch.event_handlers import OnExecutionComplete, OnProcessExit, OnProcessIO, OnProcessStart, OnShutdown
from launch.events import Shutdown
from launch.substitutions import FindExecutable, LaunchConfiguration, LocalSubstitution, PythonExpression
from launch_ros.actions import Node

def ended(event, context):
    program, *arguments = event.cmd
    told = [event.process_name, program.rpartition('/')[2], *arguments, str(event.returncode)]
    return [LogInfo(msg=' '.join(told)), EmitEvent(event=Shutdown(reason='ask is done'))]

def generate_launch_description():
    sim = Node(package='turtlesim', namespace=LaunchConfiguration('ns'), executable='turtlesim_node', name='sim')
    ask = Node(package='my_turtle', executable='ask', name='boss')
    ros2 = [FindExecutable(name='ros2')]
    spawn = ExecuteProcess(cmd=[[*ros2, ' service call ', LaunchConfiguration('ns'), '/spawn']], shell=True)
    change = ExecuteProcess(cmd=[[*ros2, ' param set']], shell=True)
    never = ExecuteProcess(
        condition=IfCondition(PythonExpression([LaunchConfiguration('r'), ' == 200 and ', 'False'])), cmd=['never']
    )
    return LaunchDescription([
        DeclareLaunchArgument('ns', default_value='turtlesim1'), DeclareLaunchArgument('r', default_value='200'),
        sim, ask,
        RegisterEventHandler(OnProcessStart(target_action=sim, on_start=[LogInfo(msg='started'), spawn])),
        RegisterEventHandler(OnProcessIO(target_action=spawn, on_stdout=lambda event: LogInfo(msg='never'))),
        RegisterEventHandler(OnExecutionComplete(target_action=spawn, on_completion=[
            LogInfo(msg='finished'), change, TimerAction(period=2.0, actions=[never])])),
        RegisterEventHandler(OnProcessExit(target_action=ask, on_exit=ended)),
        RegisterEventHandler(
            OnShutdown(on_shutdown=[LogInfo(msg=['shut down: ', LocalSubstitution('event.reason')])])),
    ])
"""


def test_the_tutorial_about_event_handlers_is_carried_out(slot: Slot) -> None:
    outcome = of(launched_as(slot, TUTORIAL, ask=ENDS))
    lines = [line.removeprefix("[INFO] [launch.user]: ") for line in outcome.stdout.text.splitlines()]
    ended = "ask-2 ask --ros-args -r __node:=boss 0"
    assert lines == ["started", "finished", ended, "shut down: ask is done"], outcome.stderr.text
    assert [note.text for note in outcome.notes if note.code == "launch_ignored"] == [
        "OnProcessIO",
        "turtlesim_node -r __node:=sim -r __ns:=/turtlesim1",
        "/usr/bin/ros2 service call turtlesim1/spawn",
        "/usr/bin/ros2 param set",
    ]
