"""rclpy.init, shutdown and contexts."""

from textwrap import dedent


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
        """UnknownROSArgsError ("Found unknown ROS args: ['--nonsense']",)""",
    ]


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


def test_shutdown_in_a_callback_ends_the_spin(run_script):
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
    assert lines(run_script, source) == ["rest of the callback", "after spin False"]


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
