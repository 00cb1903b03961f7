"""Nodes: names, remapping, creation, destruction, the graph."""

from textwrap import dedent

import pytest

PREFIX = """
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
def attempt(call):
    try:
        print(call())
    except Exception as error:
        print(type(error).__name__ + ":", error)
"""


def lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr
    return run.stdout.splitlines()


def test_names(run_script):
    source = """
        rclpy.init()
        node = Node("walker", namespace="team/red")
        print(node.get_name(), node.get_namespace(), node.get_fully_qualified_name(), node.get_logger().name)
        print(node.resolve_topic_name("a"), node.resolve_topic_name("~/a"), node.resolve_topic_name("/a"))
        node.destroy_node()
        node.destroy_node()
        attempt(node.get_name)
    """
    assert lines(run_script, source) == [
        "walker /team/red /team/red/walker team.red.walker",
        "/team/red/a /team/red/walker/a /a",
        "InvalidHandle: cannot use Destroyable because destruction was requested",
    ]


def test_invalid_names_point_at_the_character(run_script):
    source = """
        rclpy.init()
        attempt(lambda: Node("my node"))
        attempt(lambda: Node("n", namespace="a-b"))
        node = Node("n")
        attempt(lambda: node.create_publisher(Twist, "/turtle 1/cmd_vel", 10))
        attempt(lambda: node.create_service(Twist, "x", None))
        attempt(lambda: node.create_publisher("Twist", "x", 10))
    """
    letters = "must not contain characters other than alphanumerics"
    assert lines(run_script, source) == [
        f"InvalidNodeNameException: Invalid node name: node name {letters} or '_':",
        "  'my node'",
        "     ^",
        f"InvalidNamespaceException: Invalid namespace: namespace {letters}, '_', or '/':",
        "  '/a-b'",
        "     ^",
        f"InvalidTopicNameException: Invalid topic name: topic name {letters}, '_', '~', '{{', or '}}':",
        "  '/turtle 1/cmd_vel'",
        "          ^",
        "RuntimeError: The service type provided is not valid (<class 'geometry_msgs.msg._twist.Twist'>), "
        "this might be a message or action",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message "
        "type but it should be a ROS 2 message type. Make sure to source your ROS 2 workspace after your "
        "ROS 1 workspace.",
    ]


def test_remapping_and_parameters_of_the_command_line(run_script):
    source = """
        rclpy.init()
        node = Node("walker")
        print(node.get_fully_qualified_name(), node.resolve_topic_name("cmd_vel"))
        print(node.declare_parameter("speed", 1.0).value, node.declare_parameter("name", "x").value)
        print(node.declare_parameter("sides", [1]).value, node.declare_parameter("own", True).value)
        attempt(lambda: node.declare_parameter("count", "text"))
        print(rclpy.utilities.remove_ros_args())
    """
    args = "one --ros-args -r __node:=runner -r __ns:=/team -r cmd_vel:=/turtle1/cmd_vel -p speed:=2.5 "
    args += "-p name:='007' -p sides:=[3,5] -p own:=off -p count:=3 -- two"
    out = lines(run_script, source, args=args.split())
    assert out == [
        "/team/runner /turtle1/cmd_vel",
        "2.5 007",
        "[3, 5] False",
        "InvalidParameterTypeException: Trying to set parameter 'count' to '3' of type 'INTEGER', "
        "expecting type 'STRING'",
        "['student.py', 'one', 'two']",
    ]


def test_graph_shows_the_world(run_script):
    source = """
        rclpy.init()
        node = Node("watcher", enable_rosout=False, start_parameter_services=False)
        publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        node.create_subscription(Pose, "turtle1/pose", print, 10)
        print(node.get_node_names(), publisher.get_subscription_count())
        print(node.get_topic_names_and_types())
        print(node.get_service_names_and_types())
        print(node.count_publishers("turtle1/pose"), node.count_subscribers("/turtle1/cmd_vel"))
        info = node.get_publishers_info_by_topic("/turtle1/pose")[0]
        print(info.node_name, info.topic_type, info.qos_profile.reliability.name, len(info.endpoint_gid))
        print(node.get_subscriber_names_and_types_by_node("turtlesim", "/"))
        attempt(lambda: node.get_publisher_names_and_types_by_node("nobody", "/"))
    """
    assert lines(run_script, source)[:-1] == [
        "['turtlesim', 'watcher'] 1",
        "[('/parameter_events', ['rcl_interfaces/msg/ParameterEvent']), ('/rosout', ['rcl_interfaces/msg/Log']), "
        "('/turtle1/cmd_vel', ['geometry_msgs/msg/Twist']), ('/turtle1/pose', ['turtlesim/msg/Pose'])]",
        "[('/reset', ['std_srvs/srv/Empty'])]",
        "1 1",
        "turtlesim turtlesim/msg/Pose RELIABLE 24",
        "[('/parameter_events', ['rcl_interfaces/msg/ParameterEvent']), "
        "('/turtle1/cmd_vel', ['geometry_msgs/msg/Twist'])]",
    ]


def test_destroyed_entities_cannot_be_used(run_script):
    source = """
        rclpy.init()
        node = Node("n")
        publisher = node.create_publisher(Twist, "a", 10)
        timer = node.create_timer(1, print)
        print(node.destroy_publisher(publisher), node.destroy_publisher(publisher))
        attempt(lambda: publisher.publish(Twist()))
        node.destroy_node()
        attempt(timer.cancel)
        attempt(lambda: node.create_publisher(Twist, "b", 10))
    """
    refused = "InvalidHandle: cannot use Destroyable because destruction was requested"
    assert lines(run_script, source) == ["True False", refused, refused, refused]


def test_episode_is_told_of_the_students_endpoints_only(run_script):
    run = run_script(
        PREFIX
        + dedent("""
            rclpy.init()
            node = Node("walker")
            node.create_publisher(Twist, "turtle1/cmd_vel", 7)
            node.create_subscription(Pose, "/turtle1/pose", print, rclpy.qos.qos_profile_sensor_data)
            node.destroy_node()
        """)
    )
    told = [(e["what"], e["name"], e["type"], e["reliability"], e["depth"]) for e in run.of("ENTITY")]
    assert told == [
        (1, "", "", 1, 10),
        (2, "/rosout", "rcl_interfaces/msg/Log", 1, 1000),
        (2, "/turtle1/cmd_vel", "geometry_msgs/msg/Twist", 1, 7),
        (3, "/turtle1/pose", "turtlesim/msg/Pose", 2, 5),
    ]
    assert sorted(frame["id"] for frame in run.of("GONE")) == [1, 2, 3, 4]


def test_names_that_upstreams_modules_pass_on_can_be_imported_from_them(run_script):
    """What the modules of rclpy 3.3.15 import or declare is importable from them, lazily here."""
    source = """
        import rclpy
        from rclpy import _forwarding
        from importlib import import_module
        from rclpy.node import MsgType, ParameterMsg, Timer
        from rclpy.publisher import MsgType as of_publisher
        from rclpy.client import CallbackGroup, SrvTypeRequest
        from rclpy.executors import Clock, WaitableEntityType
        from rclpy.qos_overriding_options import QosCallbackResult
        import rclpy.timer, rclpy.callback_groups, rcl_interfaces.msg
        print(MsgType, of_publisher is rclpy.publisher.MsgType, ParameterMsg is rcl_interfaces.msg.Parameter)
        print(Timer is rclpy.timer.Timer, CallbackGroup is rclpy.callback_groups.CallbackGroup)
        for module, names in _forwarding._PASSED_ON.items():
            for name in names.split():
                getattr(import_module(module), name)
        try:
            from rclpy.client import nothing
        except ImportError as error:
            print(error.name)
    """
    run = run_script(dedent(source))
    assert run.stdout.splitlines() == ["~MsgType True True", "True True", "rclpy.client"], run.stderr


def test_import_star_gives_what_upstreams_modules_import(run_script):
    """None of them has an `__all__`. After `rclpy.node` the submodules are the package's, `rclpy.time` as well."""
    source = """
        import time
        from rclpy.executors import *
        from rclpy.executors import Lock, ThreadPoolExecutor
        from rclpy.node import *
        from rclpy.qos import *
        import rcl_interfaces.msg
        print(math.floor(math.pi), Optional, Timer.__name__, CallbackGroup.__name__, IntEnum.__name__)
        print(ParameterDescriptor is rcl_interfaces.msg.ParameterDescriptor, MultiThreadedExecutor.__name__)
        before = time.time()
        time.sleep(2)
        print(round(time.time() - before, 2))
        from rclpy import *
        print(callable(init), logging.__name__, time.__name__)
    """
    assert run_script(dedent(source)).stdout.splitlines() == [
        "3 typing.Optional Timer CallbackGroup IntEnum",
        "True MultiThreadedExecutor",
        "2.0",
        "True rclpy.logging rclpy.time",
    ]


RULES = (
    ("-r a:=b", ""),
    ("-r node:rosservice://~/a/b:=/c", ""),
    ("-r __ns:=/x/y", ""),
    ("-r a:=2b", "Error: error not set"),
    (
        "-r a:=b!",
        "Error: Expected lexeme type (19) not found, search ended at index 4, at ./src/rcl/lexer_lookahead.c:239",
    ),
    ("-r /*:=b", "Error: Wildcard '*' is not implemented, at ./src/rcl/arguments.c:1164"),
    ("-r __node:=1x", "Error: Expected lexeme type (18) not found, search ended at index 8"),
    ("-r __ns:=x", "Error: Expected lexeme type 19, got 18 at index 6, at ./src/rcl/lexer_lookahead.c:244"),
    ("-r __nope:=x", "Error: Expecting token or wildcard, at ./src/rcl/arguments.c:1170"),
    ("-p a", "Error: Expected lexeme type (22) not found, search ended at index 1"),
    ("-p a.:=1", "Error: Expecting token or wildcard, at ./src/rcl/arguments.c:1273"),
    ("-p node:a.b:=1", ""),
    ("--log-level :=info", "Error: Argument has an invalid logger item that name is empty"),
    ("--log-level a.b:=info", ""),
    ("-p a:=1 b:=2", "['b:=2']"),
)


def test_rules_are_refused_where_rcl_refuses_them(run_script):
    run = run_script(
        f"""
import rclpy
for given in {[given for given, _ in RULES]!r}:
    try:
        rclpy.init(args=['x', '--ros-args', *given.split()], context=rclpy.context.Context())
        print()
    except Exception as error:
        print(error)
"""
    )
    for (given, text), printed in zip(RULES, run.stdout.splitlines(), strict=True):
        assert text in printed, given
        assert bool(text) == bool(printed), given


def test_a_remap_rule_outside_ros_arguments_counts_and_is_warned_of(run_script):
    run = run_script(
        "import rclpy, sys\nrclpy.init()\nnode = rclpy.create_node('a')\n"
        "print(node.get_fully_qualified_name(), rclpy.utilities.remove_ros_args(sys.argv)[1:])\n"
        "print(rclpy.create_node('b', cli_args=['-r', '__node:=c'], use_global_arguments=False).get_name())\n",
        args=["__ns:=/q", "speed:=2.0"],
    )
    assert run.stdout == "/q/a ['speed:=2.0']\nc\n"
    assert (
        "Found remap rule '__ns:=/q'. This syntax is deprecated. Use '--ros-args --remap __ns:=/q' instead."
        in run.stderr
    )


UPSTREAM = {
    "_apply_descriptor",
    "_check_undeclared_parameters",
    "_set_parameters",
    "_set_parameters_atomically",
    "_validate_qos_or_depth_parameter",
    "_validate_topic_or_service_name",
    "_wake_executor",
}
"""Private methods of rclpy's Node that a class of its own may replace at home as well."""


def test_methods_of_a_script_replace_none_of_the_nodes_own(run_script):
    source = """
        rclpy.init()
        own = [name for name in vars(Node) if not name.startswith(("__", "_rcl_", "_Node__"))]
        print(*[name for name in own if name.startswith("_")])
        class Mover(Node):
            def __init__(self):
                self._store, self._infos, self._waitables = [], {}, 3
                super().__init__("mover")
                self._store, self._infos, self._waitables = [], {}, 3
                self.declare_parameter("speed", 1.0)
            def _start_services(self): pass
            def _destroy(self): pass
            def _add_publisher(self, name): pass
        node = Mover()
        node.create_publisher(Twist, "a", 10)
        print(node.destroy_node())
    """
    names, destroyed = lines(run_script, source)
    assert set(names.split()) <= UPSTREAM
    assert destroyed == "None"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("timers", "TypeError: 'method' object is not iterable"),
        ("clients", "TypeError: 'method' object is not iterable"),
        ("handle", "TypeError: 'method' object does not support the context manager protocol"),
        (
            "create_publisher",
            "TypeError: Car.create_publisher() takes 1 positional argument but 4 were given",
        ),
        (
            "create_service",
            "TypeError: Car.create_service() got an unexpected keyword argument 'qos_profile'",
        ),
    ],
)
def test_a_method_under_the_name_of_one_of_nodes_is_called_by_node(run_script, name, text):
    run = run_script(f"""
import rclpy
from rclpy.node import Node
class Car(Node):
    def __init__(self):
        super().__init__("car")
    def {name}(self):
        print("mine")
rclpy.init()
rclpy.spin(Car())
""")
    assert run.stderr.splitlines()[-1] == text


def test_a_dict_under_the_name_of_nodes_lists_serves_as_upstreams_loops_take_it(run_script):
    run = run_script("""
import rclpy
from rclpy.node import Node
rclpy.init()
class Car(Node):
    def __init__(self):
        super().__init__("car")
        self.tick = self.create_timer(1, lambda: print("tick"))
        self._clients = {}
        self._subscriptions = {}
        self._guards = ()
car = Car()
rclpy.spin_once(car)
car._timers = {"tick": car.tick}
other = rclpy.executors.SingleThreadedExecutor()
other.add_node(car)
other.spin_once()
""")
    assert run.stdout == "tick\n"
    assert run.stderr.splitlines()[-1] == "AttributeError: 'str' object has no attribute '_executor_event'"


def test_a_node_leaves_the_graph_when_nothing_refers_to_it(run_script):
    source = """
        rclpy.init()
        def make(keep):
            node = Node("a")
            node.publisher = node.create_publisher(Twist, "x", 1)
            if keep:
                return node.publisher
        watcher = Node("watcher")
        make(False)
        print(watcher.get_node_names(), watcher.count_publishers("x"))
        publisher = make(True)
        print(watcher.get_node_names(), watcher.count_publishers("x"))
    """
    assert lines(run_script, source) == ["['turtlesim', 'watcher'] 0", "['turtlesim', 'watcher', 'a'] 1"]
