"""rclpy.init, shutdown and contexts."""

from textwrap import dedent

import pytest


def lines(run_script, source, **options):
    run = run_script(dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr
    return run.stdout.splitlines()


def test_ok_follows_init_and_shutdown(run_script):
    source = """
        import rclpy
        print(rclpy.ok())
        print(rclpy.init(), rclpy.ok())
        print(rclpy.shutdown(), rclpy.ok())
        rclpy.init()
        print(rclpy.ok(), rclpy.try_shutdown(), rclpy.try_shutdown(), rclpy.ok())
    """
    assert lines(run_script, source) == ["False", "None True", "None False", "True None None False"]


def test_misuse_raises_upstreams_errors(run_script):
    source = """
        import rclpy
        from rclpy.node import Node
        def attempt(call):
            try:
                call()
            except BaseException as error:
                print(type(error).__name__, error.args)
        attempt(lambda: Node("early"))
        attempt(lambda: rclpy.init([]))
        attempt(lambda: rclpy.init(domain_id=-1))
        rclpy.init()
        attempt(rclpy.init)
        rclpy.shutdown()
        attempt(rclpy.shutdown)
        attempt(lambda: rclpy.spin(None))
        attempt(lambda: rclpy.init(args=["x", "--ros-args", "--nonsense"]))
    """
    assert lines(run_script, source) == [
        "NotInitializedException ('rclpy.init() has not been called', 'cannot create node')",
        "TypeError ('init() takes 0 positional arguments but 1 was given',)",
        "RuntimeError ('Domain id (-1) should not be lower than zero.',)",
        "RuntimeError ('Context.init() must only be called once',)",
        "RuntimeError ('Context must be initialized before it can be shutdown',)",
        "AttributeError ('__enter__',)",
        """UnknownROSArgsError ("['--nonsense']",)""",
    ]


@pytest.mark.parametrize(
    ("args", "text"),
    [
        (
            "'turtle'",
            "__init__(): incompatible constructor arguments. The following argument types are supported:\n"
            "    1. rclpy._rclpy_pybind11.Context(arg0: list, arg1: int)\n\n"
            "Invoked with: 'turtle', 18446744073709551615",
        ),
        ("['drive', 2]", "bad argument type for built-in operation"),
    ],
)
def test_arguments_are_a_list_of_texts(run_script, args, text):
    run = run_script(f"import rclpy\nrclpy.init(args={args})")
    assert run.exit["text"].endswith(f"\nTypeError: {text}\n")


def test_what_students_look_for_in_vain_does_not_exist(run_script):
    source = """
        import rclpy
        from rclpy.node import Node
        from geometry_msgs.msg import Twist
        rclpy.init()
        node = Node("n")
        publisher = node.create_publisher(Twist, "t", 10)
        for thing, name in (
            (rclpy, "Rate"), (rclpy, "sleep"), (rclpy, "is_shutdown"), (node, "get_time"),
            (publisher, "wait_for_subscribers"), (node.get_clock().now(), "to_sec"), (Twist(), "linear_x"),
        ):
            print(hasattr(thing, name), end=" ")
    """
    assert lines(run_script, source) == ["False " * 7]


def test_ctrl_c_shuts_contexts_down_before_the_exception(run_script):
    run = run_script(
        dedent("""
            import rclpy
            from rclpy.node import Node
            from geometry_msgs.msg import Twist
            rclpy.init()
            node = Node("mover")
            publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
            try:
                rclpy.spin(node)
            except KeyboardInterrupt:
                print("interrupted", rclpy.ok())
            finally:
                try:
                    publisher.publish(Twist())
                except RuntimeError as error:
                    print(type(error), error)
                node.get_logger().info("bye")
                node.destroy_node()
                rclpy.shutdown()
        """),
        horizon_s=3,
    )
    assert run.stdout.splitlines() == [
        "interrupted False",
        "<class 'rclpy._rclpy_pybind11.RCLError'> Failed to publish: publisher's context is invalid, "
        "at ./src/rcl/publisher.c:389",
    ]
    assert "[INFO] [1700000003.00000" in run.stderr
    assert "Failed to publish log message to rosout: publisher's context is invalid" in run.stderr
    assert (run.exit["type"], run.exit["after_interrupt"]) == ("RCLError", 1)
    assert run.exit["message"] == (
        "failed to shutdown: rcl_shutdown already called on the given context, at ./src/rcl/init.c:241"
    )


def test_without_signal_handlers_ctrl_c_leaves_the_context_alone(run_script):
    run = run_script(
        dedent("""
            import rclpy
            rclpy.init(signal_handler_options=rclpy.SignalHandlerOptions.NO)
            node = rclpy.create_node("n")
            try:
                rclpy.spin(node)
            except KeyboardInterrupt:
                print(rclpy.ok())
            rclpy.shutdown()
        """),
        horizon_s=1,
    )
    assert (run.stdout, run.exit["reason"]) == ("True\n", 0)


@pytest.mark.parametrize("distro", ["humble", "jazzy"])
def test_shutdown_in_a_callback_ends_the_spin_and_the_student_is_told_that_humble_hangs(run_script, distro):
    source = """
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        def tick():
            rclpy.shutdown()
            print("rest of the callback")
        node.create_timer(0.5, tick)
        rclpy.spin(node)
        print("after spin", rclpy.ok())
    """
    run = run_script(dedent(source), distro=distro)
    assert run.stdout == "rest of the callback\nafter spin False\n"
    assert run.notes == ([("shutdown_in_callback", "6")] if distro == "humble" else [])


@pytest.mark.parametrize("called", ["rclpy.shutdown", "executor.shutdown"])
def test_no_line_is_blamed_where_shutdown_itself_is_the_callback(run_script, called):
    source = f"""
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        executor = rclpy.get_global_executor()
        executor.add_node(node)
        node.create_timer(0.5, {called})
        executor.spin()
    """
    assert run_script(dedent(source)).notes == []


def test_shutdown_beside_a_coroutine_that_waits_for_ever_is_told(run_script):
    source = """
        import rclpy
        rclpy.init()
        node = rclpy.create_node("m")
        async def wait_for_ever(): await rclpy.task.Future()
        def leave(): raise SystemExit
        node.create_timer(0.1, wait_for_ever)
        node.create_timer(0.5, leave, callback_group=rclpy.callback_groups.ReentrantCallbackGroup())
        try:
            rclpy.spin(node)
        finally:
            rclpy.shutdown()
    """
    assert run_script(dedent(source)).notes == [("shutdown_in_callback", "12")]


def test_only_the_first_shutdown_in_a_callback_is_told(run_script):
    source = """
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        def tick():
            node.executor.shutdown()
            rclpy.shutdown()
        node.create_timer(0.5, tick)
        rclpy.spin(node)
    """
    assert run_script(dedent(source)).notes == [("shutdown_in_callback", "6")]


def test_a_coroutine_that_calls_shutdown_is_told_too(run_script):
    source = """
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        later = rclpy.task.Future()
        async def tick():
            await later
            rclpy.shutdown()
        node.create_timer(0.5, tick)
        group = rclpy.callback_groups.ReentrantCallbackGroup()
        node.create_timer(0.7, lambda: later.set_result(None), callback_group=group)
        rclpy.spin(node)
    """
    assert run_script(dedent(source)).notes == [("shutdown_in_callback", "8")]


def test_shutdown_from_another_thread_ends_the_spin(run_script):
    source = """
        import threading, time, rclpy
        from rclpy.executors import ExternalShutdownException
        context = rclpy.context.Context()
        rclpy.init(context=context)
        node = rclpy.create_node("n", context=context)
        executor = __import__("rclpy.executors").executors.SingleThreadedExecutor(context=context)
        def end():
            time.sleep(2)
            context.shutdown()
        threading.Thread(target=end).start()
        try:
            rclpy.spin(node, executor)
        except ExternalShutdownException as error:
            print(type(error))
    """
    assert lines(run_script, source) == ["<class 'rclpy.executors.ExternalShutdownException'>"]


AFTER_SHUTDOWN = """
import rclpy
from rclpy.node import Node
from rclpy.action import ActionClient, ActionServer
from example_interfaces.action import Fibonacci
from std_msgs.msg import Int32
from std_srvs.srv import Trigger
rclpy.init()
n = Node("n")
publisher = n.create_publisher(Int32, "x", 10)
client = n.create_client(Trigger, "t")
actions = ActionClient(n, Fibonacci, "f")
context = n.context
rclpy.shutdown()
def show(call):
    try:
        print("no error:", call())
    except Exception as error:
        print(type(error).__name__, error, sep="|")
"""

GUARD = (
    "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called., "
    "at ./src/rcl/guard_condition.c:67"
)
NODE = "rcl node's context is invalid, at ./src/rcl/node.c:428"
PUBLISHER = "publisher's context is invalid, at ./src/rcl/publisher.c:389"


def test_after_shutdown_everything_fails_with_upstreams_texts(run_script):
    """Texts of rclpy's src/rclpy/*.cpp, then rcl's: timer.c:158, guard_condition.c:66, node.c:428, graph.c:85."""
    expected = {
        "n.create_timer(1, print)": f"RCLError|failed to create timer: {GUARD}",
        "n.create_rate(1)": f"RCLError|failed to create timer: {GUARD}",
        "n.create_guard_condition(print)": f"RCLError|failed to create guard_condition: {GUARD}",
        "n.create_publisher(Int32, 'y', 1)": f"RCLError|Failed to create publisher: {NODE}",
        "n.create_subscription(Int32, 'y', print, 1)": f"RCLError|Failed to create subscription: {NODE}",
        "n.create_client(Trigger, 'y')": f"RCLError|failed to create client: {NODE}",
        "n.create_service(Trigger, 'y', print)": f"RCLError|failed to create service: {NODE}",
        "ActionClient(n, Fibonacci, 'g')": f"ValueError|Failed to create action client: {NODE}",
        "ActionServer(n, Fibonacci, 'g', print)": f"ValueError|Failed to create action server: {NODE}",
        "n.declare_parameter('p', 1)": f"RCLError|Failed to publish: {PUBLISHER}",
        "n.get_topic_names_and_types()": f"RCLError|failed to get topic names and types: {NODE}",
        "n.get_service_names_and_types()": f"RCLError|failed to get service names and types: {NODE}",
        "n.get_node_names()": f"RCLError|Failed to get node names: {NODE}",
        "n.get_node_names_and_namespaces()": f"RCLError|Failed to get node names: {NODE}",
        "n.get_publisher_names_and_types_by_node('n', '/')": "RCLError|failed to get publisher names and types: "
        + NODE,
        "n.get_client_names_and_types_by_node('n', '/')": f"RCLError|failed to get client names and types: {NODE}",
        "n.count_publishers('x')": f"RCLError|Error in rcl_count_publishers: {NODE}",
        "n.count_subscribers('x')": f"RCLError|Error in rcl_count_subscribers: {NODE}",
        "n.get_publishers_info_by_topic('x')": "RCLError|Failed to get information by topic for publishers: "
        + NODE,
        "n.get_subscriptions_info_by_topic('x')": "RCLError|Failed to get information by topic for subscriptions: "
        + NODE,
        "publisher.get_subscription_count()": f"RCLError|failed to get subscription count: {PUBLISHER}",
        "publisher.assert_liveliness()": f"RCLError|Failed to assert liveliness on the Publisher: {PUBLISHER}",
        "client.wait_for_service(1.0)": f"RCLError|failed to check service availability: {NODE}",
        "actions.server_is_ready()": f"RCLError|Failed to check if action server is available: {NODE}",
        "rclpy.executors.SingleThreadedExecutor(context=context)": "RCLError|failed to create guard_condition: "
        + GUARD,
    }
    source = AFTER_SHUTDOWN + "".join(f"show(lambda: {call})\n" for call in expected)
    run = run_script(source)
    assert dict(zip(expected, run.stdout.splitlines(), strict=True)) == expected


def test_a_destroyed_node_stores_no_parameters(run_script):
    """Upstream asks for the node's namespace before it stores anything (node.py, _set_parameters_atomically)."""
    source = """
        import rclpy
        rclpy.init()
        node = rclpy.create_node("n")
        node.destroy_node()
        try:
            node.declare_parameter("p", 1)
        except RuntimeError as error:
            print(type(error).__name__, node.has_parameter("p"))
    """
    assert lines(run_script, source) == ["InvalidHandle False"]
