"""Managed nodes."""

from textwrap import dedent


def test_transitions_publishers_and_services(run_script):
    run = run_script(
        dedent("""
            import rclpy
            from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
            from lifecycle_msgs.srv import ChangeState, GetState
            from std_msgs.msg import String
            class Talker(LifecycleNode):
                def on_configure(self, state):
                    print("configure from", state.label, state.state_id)
                    return super().on_configure(state)
            rclpy.init()
            node = Talker("talker")
            publisher = node.create_lifecycle_publisher(String, "t", 10)
            node.create_subscription(String, "t", lambda m: print("heard", m.data), 10)
            publisher.publish(String(data="too early"))
            def call(kind, name, request):
                client = node.create_client(kind, f"/talker/{name}")
                future = client.call_async(request)
                rclpy.spin_until_future_complete(node, future)
                return future.result()
            request = ChangeState.Request()
            request.transition.label = "configure"
            print(call(ChangeState, "change_state", request).success)
            print(call(GetState, "get_state", GetState.Request()).current_state.label)
            print(node.trigger_activate(), publisher.is_activated)
            publisher.publish(String(data="active"))
            for _ in range(3):
                rclpy.spin_once(node, timeout_sec=0.1)
            try:
                node.trigger_activate()
            except RuntimeError as error:
                print(type(error).__name__)
            print(node.trigger_deactivate(), node.trigger_shutdown())
        """)
    )
    assert run.exit["reason"] == 0, run.stderr
    assert run.stdout.splitlines() == [
        "configure from unconfigured 1",
        "True",
        "inactive",
        "TransitionCallbackReturnType.SUCCESS True",
        "heard active",
        "RCLError",
        "TransitionCallbackReturnType.SUCCESS TransitionCallbackReturnType.SUCCESS",
    ]


def test_an_invalid_transition_is_warned_of(run_script):
    """rcl_lifecycle.c:319 and 340 log it before the exception."""
    run = run_script(
        dedent("""
            import rclpy
            from rclpy.lifecycle import LifecycleNode
            rclpy.init()
            node = LifecycleNode("talker")
            for trigger in (node.trigger_activate, node.trigger_configure, node.trigger_configure):
                try:
                    print(trigger())
                except RuntimeError as error:
                    print(type(error).__name__, error)
        """)
    )
    refused = (
        "RCLError Failed to trigger lifecycle state machine transition: Transition is not registered., "
        "at ./src/rcl_lifecycle.c:355"
    )
    assert run.stdout.splitlines() == [refused, "TransitionCallbackReturnType.SUCCESS", refused]
    warned = [line.partition("] [")[2].partition("] ")[2] for line in run.stderr.splitlines()]
    assert warned == [
        "[rcl_lifecycle]: No transition matching 3 found for current state unconfigured",
        "[rcl_lifecycle]: No transition matching 1 found for current state inactive",
    ]
