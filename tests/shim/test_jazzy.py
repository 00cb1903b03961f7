"""What Jazzy adds to Humble or does otherwise, and that neither has what only the other has."""

from collections.abc import Callable

import pytest

from tests.shim.conftest import Run

RunScript = Callable[..., Run]

NODE = """
import rclpy
from rclpy.node import Node
rclpy.init()
node = Node("n")
"""

ONLY_ON_JAZZY = (
    "import rclpy.event_handler",
    "import rclpy.parameter_client",
    "from rclpy.clock_type import ClockType",
    "from rclpy import type_hash",
    "import service_msgs.msg",
    "from geometry_msgs.msg import PolygonInstance",
    "from rclpy.qos import qos_profile_best_available",
    "node.wait_for_node",
    "node.list_parameters",
    "Node('b', enable_logger_service=True)",
    "node.create_timer(1.0, print, autostart=False)",
    "type(node.create_timer(1.0, print).handle)(node.get_clock().handle, node.context.handle, 1, False)",
    "rclpy.qos.ReliabilityPolicy.BEST_AVAILABLE",
    "rclpy.context.Context().__enter__",
    "rclpy.executors.Executor.__exit__",
    "from std_srvs.srv import Trigger; Trigger.Event",
)


@pytest.mark.parametrize("warm", [False, True])
@pytest.mark.parametrize("distro", ["humble", "jazzy"])
def test_what_only_jazzy_has_is_on_jazzy_only(run_script: RunScript, distro: str, warm: bool) -> None:
    probe = f"""
for line in {ONLY_ON_JAZZY!r}:
    try:
        exec(line)
    except (ImportError, AttributeError, TypeError) as error:
        print(line, "->", type(error).__name__)
"""
    missing = run_script(NODE + probe, distro=distro, warm=warm).stdout.splitlines()
    assert [line.partition(" -> ")[0] for line in missing] == (
        [] if distro == "jazzy" else list(ONLY_ON_JAZZY)
    )


@pytest.mark.parametrize("warm", [False, True])
def test_what_modules_have_copied_of_each_other_changes_with_it(run_script: RunScript, warm: bool) -> None:
    source = (
        "import rclpy.timer, rclpy.clock\n"
        "rclpy.timer.Timer(print, None, 1, rclpy.clock.Clock(), context=rclpy.context.Context())\n"
    )
    message = "'NoneType' object does not support the context manager protocol"
    assert run_script(source, distro="jazzy", warm=warm).exit["message"] == message


@pytest.mark.parametrize("warm", [False, True])
def test_imports_bring_what_they_bring_at_home(run_script: RunScript, warm: bool) -> None:
    run = run_script(
        "import rclpy, os, warnings\n"
        "print(os.environ['ROS_DISTRO'], hasattr(rclpy, 'node'), hasattr(rclpy, 'clock_type'))\n"
        "import rclpy.node\n"
        "print(hasattr(rclpy, 'event_handler'), hasattr(rclpy, 'qos_event'))\n"
        "with warnings.catch_warnings(record=True) as caught:\n"
        "    from rclpy.qos_event import PublisherEventCallbacks\n"
        "print(PublisherEventCallbacks.__module__, *(w.message for w in caught))\n",
        distro="jazzy",
        warm=warm,
    )
    assert run.stdout == (
        "jazzy False False\n"
        "True False\n"
        "rclpy.event_handler importing 'qos_event' is deprecated; import 'event_handler' instead\n"
    )


def test_a_wrong_type_passes_the_setter_and_aborts_the_process_at_publish(run_script: RunScript) -> None:
    source = (
        "from geometry_msgs.msg import Twist\n"
        "publisher = node.create_publisher(Twist, 'nobody_listens', 10)\n"
        "twist = Twist(liner=1.0)\n"
        "twist.linear.x = 1\n"
        "print(twist.linear)\n"
        "try:\n"
        "    publisher.publish(twist)\n"
        "finally:\n"
        "    print('never')\n"
    )
    run = run_script(NODE + source, distro="jazzy")
    assert run.stdout == "geometry_msgs.msg.Vector3(x=1, y=0.0, z=0.0)\n"
    assert run.stderr == (
        "python3: ./.obj-x86_64-linux-gnu/rosidl_generator_py/geometry_msgs/msg/_vector3_s.c: "
        "geometry_msgs__msg__vector3__convert_from_py: Assertion `PyFloat_Check(field)' failed.\n"
    )
    assert (run.exit["type"], run.exit["code"], run.exit["line"]) == ("Aborted", 134, 12)
    assert run.exit["message"].startswith("field 'x' of geometry_msgs/msg/Vector3: ")


@pytest.mark.parametrize(
    ("setting", "condition"),
    [
        ("msg = String(); msg.data = 5", "PyUnicode_Check(field)"),
        ("msg = Bool(); msg.data = 1", "PyBool_Check(field)"),
        ("msg = UInt8(); msg.data = 1.5", "PyLong_Check(field)"),
        (
            "msg = Header(); msg.stamp = 3",
            'strncmp("builtin_interfaces.msg._time.Time", full_classname_dest, 33) == 0',
        ),
    ],
)
def test_each_kind_of_field_has_its_assertion(run_script: RunScript, setting: str, condition: str) -> None:
    source = (
        "from std_msgs.msg import Bool, Header, String, UInt8\n"
        f"{setting}\nnode.create_publisher(type(msg), 't', 1).publish(msg)\n"
    )
    run = run_script(NODE + source, distro="jazzy")
    assert run.exit["message"].endswith(f"Assertion `{condition}' failed.")


def test_fields_are_checked_where_that_is_wanted_and_numbers_are_cut_as_in_c(run_script: RunScript) -> None:
    run = run_script(
        "from rclpy.serialization import deserialize_message, serialize_message\n"
        "from std_msgs.msg import Float64, Int8, Float64MultiArray\n"
        "print(deserialize_message(serialize_message(Int8(data=200)), Int8))\n"
        "print(Float64MultiArray(data=[1, 2]).data)\n"
        "Float64(check_fields=True).data = 1\n",
        distro="jazzy",
    )
    assert run.stdout == "std_msgs.msg.Int8(data=-56)\narray('d', [1.0, 2.0])\n"
    assert run.exit["message"] == "The 'data' field must be of type 'float'"


def test_contexts_and_executors_close_themselves(run_script: RunScript) -> None:
    run = run_script(
        "from rclpy.context import Context\n"
        "from rclpy.executors import SingleThreadedExecutor\n"
        "from rclpy.node import Node\n"
        "with Context() as context:\n"
        "    node = Node('n', context=context)\n"
        "    timer = node.create_timer(1.0, lambda: print('tick'), autostart=False)\n"
        "    with SingleThreadedExecutor(context=context) as executor:\n"
        "        executor.add_node(node)\n"
        "        executor.spin_once(timeout_sec=3.0)\n"
        "        timer.reset()\n"
        "        executor.spin_once(timeout_sec=3.0)\n"
        "print(context.ok(), executor._is_shutdown)\n",
        distro="jazzy",
    )
    assert run.stdout == "tick\nFalse True\n"


def test_a_call_gives_up_and_a_node_is_waited_for_in_virtual_time(run_script: RunScript) -> None:
    run = run_script(
        NODE + "import time\n"
        "from std_srvs.srv import Trigger\n"
        "client = node.create_client(Trigger, 'nobody')\n"
        "began = time.time()\n"
        "print(client.call(Trigger.Request(), timeout_sec=2.0), client.service_name)\n"
        "print(node.wait_for_node('turtlesim', 5.0), node.wait_for_node('/other', 1.0))\n"
        "print(round(time.time() - began, 3), node.count_services('/reset'), node.count_clients('nobody'))\n",
        distro="jazzy",
    )
    assert run.stdout == "None /nobody\nTrue False\n3.1 1 1\n"


def test_parameters_are_changed_before_and_told_after(run_script: RunScript) -> None:
    run = run_script(
        NODE + "from rclpy.parameter import Parameter\n"
        "from rclpy.parameter_event_handler import ParameterEventHandler\n"
        "node.declare_parameter('a.speed', 1.0)\n"
        "node.add_pre_set_parameters_callback(lambda ps: [Parameter(p.name, value=p.value * 2) for p in ps])\n"
        "node.add_post_set_parameters_callback(lambda ps: print('now', ps[0].value))\n"
        "handler = ParameterEventHandler(node)\n"
        "handler.add_parameter_callback('a.speed', 'n', lambda p: print('heard', p.value.double_value))\n"
        "node.set_parameters([Parameter('a.speed', value=2.0)])\n"
        "rclpy.spin_once(node, timeout_sec=1.0)\n"
        "print(node.list_parameters(['a'], 0))\n"
        "node.get_parameter('b')\n",
        distro="jazzy",
    )
    assert run.stdout == (
        "now 4.0\nheard 4.0\nrcl_interfaces.msg.ListParametersResult(names=['a.speed'], prefixes=['a'])\n"
    )
    assert run.exit["message"] == "Invalid access to undeclared parameter(s): b"


def test_a_subscription_is_told_of_partners_and_message_infos(run_script: RunScript) -> None:
    run = run_script(
        NODE + "from rclpy.event_handler import SubscriptionEventCallbacks\n"
        "from std_msgs.msg import String\n"
        "events = SubscriptionEventCallbacks(matched=lambda i: print('matched', i.current_count))\n"
        "callback = lambda msg, info: print(msg.data, info['publication_sequence_number'])\n"
        "subscription = node.create_subscription(String, 't', callback, 10, event_callbacks=events)\n"
        "publisher = node.create_publisher(String, 't', 10)\n"
        "publisher.publish(String(data='hi'))\n"
        "for _ in range(2):\n"
        "    rclpy.spin_once(node, timeout_sec=0.1)\n"
        "print(subscription.get_publisher_count())\n"
        "node.destroy_publisher(publisher)\n"
        "rclpy.spin_once(node, timeout_sec=0.1)\n"
        "node.create_subscription(String, 't', lambda: None, 10)\n",
        distro="jazzy",
    )
    assert run.stdout == "matched 1\nhi 1\n1\nmatched 0\n"
    assert run.exit["type"] == "RuntimeError"


def test_child_loggers_publish_on_rosout(run_script: RunScript) -> None:
    run = run_script(NODE + "node.get_logger().get_child('part').info('hello')\n", distro="jazzy")
    assert "[INFO] [1700000000.000000000] [n.part]: hello\n" in run.stderr
    ((_, cdr),) = run.published("/rosout")
    assert b"n.part" in cdr


def test_types_have_the_hashes_of_rep_2016(run_script: RunScript) -> None:
    run = run_script(
        NODE + "from geometry_msgs.msg import Twist\n"
        "from std_msgs.msg import Empty, String\n"
        "for kind in (String, Twist, Empty):\n"
        "    node.create_publisher(kind, kind.__name__, 1)\n"
        "    print(node.get_publishers_info_by_topic(kind.__name__)[0].topic_type_hash)\n",
        distro="jazzy",
    )
    assert run.stdout.split() == [
        "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
        "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
        "RIHS01_20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312",
    ]


def test_services_tell_what_they_send(run_script: RunScript) -> None:
    run = run_script(
        NODE + "from rclpy.qos import qos_profile_system_default as qos\n"
        "from rclpy.service_introspection import ServiceIntrospectionState as State\n"
        "from std_srvs.srv import SetBool\n"
        "service = node.create_service(SetBool, 's', lambda request, response: response)\n"
        "service.configure_introspection(node.get_clock(), qos, State.CONTENTS)\n"
        "tell = lambda event: print(event.info.event_type, *(r.data for r in event.request))\n"
        "node.create_subscription(SetBool.Event, 's/_service_event', tell, 10)\n"
        "future = node.create_client(SetBool, 's').call_async(SetBool.Request(data=True))\n"
        "while rclpy.ok():\n"
        "    rclpy.spin_once(node)\n",
        horizon_s=1,
        distro="jazzy",
    )
    assert run.stdout == "1 True\n2\n"


@pytest.mark.parametrize("distro", ["humble", "jazzy"])
def test_create_node_refuses_an_unknown_argument_in_its_own_name(run_script: RunScript, distro: str) -> None:
    run = run_script("import rclpy\nrclpy.init()\nrclpy.create_node('a', bogus=1)\n", distro=distro)
    assert "TypeError: create_node() got an unexpected keyword argument 'bogus'" in run.stderr


@pytest.mark.parametrize(
    ("distro", "printed"),
    [
        ("humble", ["/pose Topic.POSE", "1 State.TURN |TURN", "1 ReliabilityPolicy.RELIABLE"]),
        ("jazzy", ["/Topic.POSE Topic.POSE", "1 1 |   1", "1 1"]),
    ],
)
def test_enumerations_print_as_in_the_releases_python(
    run_script: RunScript, distro: str, printed: list[str]
) -> None:
    """Python 3.10 formats a mixed-in value where 3.11 and newer format what ``str`` gives."""
    run = run_script(
        "from enum import Enum, IntEnum\n"
        "from rclpy.qos import ReliabilityPolicy\n"
        "Topic = Enum('Topic', {'POSE': 'pose'}, type=str)\n"
        "State = IntEnum('State', 'TURN')\n"
        "class Named(IntEnum):\n    TURN = 1\n    def __str__(self): return self.name\n"
        "print(f'/{Topic.POSE}', Topic.POSE)\n"
        "print(f'{State.TURN}', State.TURN, f'|{Named.TURN:>4}')\n"
        "print(f'{ReliabilityPolicy.RELIABLE}', ReliabilityPolicy.RELIABLE)\n",
        distro=distro,
    )
    assert run.stdout.splitlines() == printed


DEFAULTS = """
from dataclasses import dataclass, field
from geometry_msgs.msg import Twist
@dataclass
class Gains:
    kp: float = 1.0
try:
    @dataclass
    class Plan:
        gains: Gains = Gains()
        stop: Twist = field(default=Twist())
    print(Plan().gains, Plan.stop == Plan().stop == Twist())
    @dataclass
    class Path:
        points: list = []
except ValueError as error:
    print(error)
"""


@pytest.mark.parametrize(
    ("distro", "printed"),
    [
        ("humble", ["Gains(kp=1.0) True", "mutable default <class 'list'> for field points is not"]),
        ("jazzy", ["mutable default <class '__main__.Gains'> for field gains is not"]),
    ],
)
def test_data_classes_take_the_defaults_that_the_releases_python_takes(
    run_script: RunScript, distro: str, printed: list[str]
) -> None:
    """Python 3.10 refuses lists, dicts and sets, 3.11 and newer whatever cannot be hashed, such as messages."""
    run = run_script(DEFAULTS, distro=distro)
    assert [line.partition(" allowed")[0] for line in run.stdout.splitlines()] == printed


@pytest.mark.parametrize(
    ("distro", "outcome"),
    [("humble", "1 done"), ("jazzy", "Passing coroutines is forbidden, use tasks explicitly.")],
)
def test_asyncio_waits_for_coroutines_where_the_releases_python_does(
    run_script: RunScript, distro: str, outcome: str
) -> None:
    run = run_script(
        "import asyncio\n"
        "async def main():\n"
        "    done, _ = await asyncio.wait([asyncio.sleep(1), asyncio.sleep(2)], timeout=1.5)\n"
        "    print(len(done), 'done')\n"
        "try: asyncio.run(main())\n"
        "except TypeError as error: print(error)\n",
        distro=distro,
    )
    assert run.stdout == f"{outcome}\n"
    warned = "DeprecationWarning: The explicit passing of coroutine objects to asyncio.wait()"
    assert (warned in run.stderr) is (distro == "humble")


def test_nodes_refuse_what_is_no_argument_in_pythons_words(run_script: RunScript) -> None:
    run = run_script(
        "import rclpy\nfrom rclpy.node import Node\nrclpy.init()\n"
        "for make in Node, rclpy.create_node:\n"
        "    for names, options in ((), {}), ((), {'name': 'a'}), (('a', 'b'), {}), (('a',), {'foo': 1}):\n"
        "        try: make(*names, **options)\n"
        "        except TypeError as error: print(error)\n"
        "    print(make('a', namespace='b', enable_logger_service=True).get_fully_qualified_name())\n",
        distro="jazzy",
    )
    assert run.stdout.splitlines() == [
        "Node.__init__() missing 1 required positional argument: 'node_name'",
        "Node.__init__() got an unexpected keyword argument 'name'",
        "Node.__init__() takes 2 positional arguments but 3 were given",
        "Node.__init__() got an unexpected keyword argument 'foo'",
        "/b/a",
        "create_node() missing 1 required positional argument: 'node_name'",
        "create_node() got an unexpected keyword argument 'name'",
        "create_node() takes 1 positional argument but 2 were given",
        "create_node() got an unexpected keyword argument 'foo'",
        "/b/a",
    ]
