"""Logging: format, levels, filters, /rosout."""

import struct
from textwrap import dedent

PREFIX = """
import time
import rclpy
import rclpy.logging
rclpy.init()
node = rclpy.create_node("talker", namespace="ns")
log = node.get_logger()
"""


def run_and_stderr(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr
    return run, run.stderr.splitlines()


def test_format_and_severities(run_script):
    source = """
        time.sleep(1.25)
        print(log.debug("你好"))
        print(log.info("你好"))
        print(log.warn("你好"))
        print(log.warning("你好"))
        print(log.error("你好"))
        print(log.fatal("你好"))
        log.get_child("arm").info("child")
    """
    run, err = run_and_stderr(run_script, source)
    assert run.stdout.split() == ["False"] + ["True"] * 5
    stamp = "[1700000001.250000000]"
    names = ["INFO", "WARN", "WARN", "ERROR", "FATAL"]
    assert err == [f"[{name}] {stamp} [ns.talker]: 你好" for name in names] + [
        f"[INFO] {stamp} [ns.talker.arm]: child"
    ]


def test_levels(run_script):
    source = """
        from rclpy.logging import LoggingSeverity
        print(log.get_effective_level(), log.is_enabled_for(LoggingSeverity.DEBUG))
        log.set_level(LoggingSeverity.DEBUG)
        log.debug("shown")
        log.get_child("arm").debug("shown too")
        rclpy.logging.set_logger_level("ns", 50)
        rclpy.logging.get_logger("ns.other").error("hidden")
        try:
            log.set_level(25)
        except ValueError as error:
            print(error)
    """
    run, err = run_and_stderr(run_script, source)
    assert run.stdout.splitlines() == ["LoggingSeverity.INFO False", "25 is not a valid LoggingSeverity"]
    assert [line.partition("]: ")[2] for line in err] == ["shown", "shown too"]


def test_the_command_line_sets_levels(run_script):
    args = ["--ros-args", "--log-level", "warn", "--log-level", "ns.talker:=debug"]
    _, err = run_and_stderr(
        run_script, "log.debug('a')\nrclpy.logging.get_logger('other').info('b')\n", args=args
    )
    assert [line.partition("]: ")[2] for line in err] == ["a"]


def test_once_skip_first_and_throttle(run_script):
    source = """
        for i in range(5):
            log.info(f"once {i}", once=True)
            log.info(f"skip {i}", skip_first=True)
            log.info(f"throttle {i}", throttle_duration_sec=1.0)
            time.sleep(0.4)
    """
    _, err = run_and_stderr(run_script, source)
    assert [line.partition("]: ")[2] for line in err] == [
        "once 0", "throttle 0", "skip 1", "skip 2", "skip 3", "throttle 3", "skip 4",
    ]  # fmt: skip


def test_each_call_site_has_its_own_filters(run_script):
    source = """
        class A:
            def speak(self):
                log.info("a", once=True); log.info("b", once=True)
        class B:
            def speak(self):
                log.info("c", once=True); log.info("d", once=True)
        for _ in range(2):
            A().speak()
            B().speak()
        def at(period):
            try:
                log.info("e", throttle_duration_sec=period)
            except ValueError as error:
                print(error)
        for period in (1.0, 1, 2.0, 0):
            at(period)
        lambdas = [lambda: log.info("f", once=True), lambda: (
            log.info("g", once=True))]
        for call in lambdas * 2:
            call()
    """
    run, err = run_and_stderr(run_script, source)
    assert [line.partition("]: ")[2] for line in err] == ["a", "b", "c", "d", "e", "f", "g"]
    assert run.stdout.splitlines() == [
        "Logging filter parameters cannot be changed between calls.",
        "Requested logging filters cannot be changed between calls.",
    ]


def test_misused_filters(run_script):
    source = """
        def attempt(**options):
            try:
                log.info("x", **options)
            except (TypeError, ValueError) as error:
                print(type(error).__name__, error)
        attempt(nonsense=1)
        attempt(throttle_duration_sec=1.0, throttle_time_source_type="RCUTILS_STEADY_TIME")
        for severity in (20, 30):
            try:
                log.log("y", severity)
            except ValueError as error:
                print(error)
    """
    run, _ = run_and_stderr(run_script, source)
    assert run.stdout.splitlines() == [
        'TypeError parameter "nonsense" is not one of the recognized logging options '
        "\"['throttle_duration_sec', 'throttle_time_source_type', 'skip_first', 'once']\"",
        'ValueError Received throttle_time_source_type of "RCUTILS_STEADY_TIME" is not a clock instance',
        "Logger severity cannot be changed between calls.",
    ]


def test_rosout_carries_the_record(run_script):
    source = """
        def speak():
            log.warning("careful")
        speak()
    """
    run, _ = run_and_stderr(run_script, source)
    ((t_ns, cdr),) = run.published("/rosout")
    assert t_ns == 0
    assert struct.unpack_from("<iIB", cdr, 4) == (1_700_000_000, 0, 30)
    for text in (b"ns.talker\0", b"careful\0", b"student.py\0", b"speak\0"):
        assert text in cdr
    assert struct.unpack("<I", cdr[-4:]) == (10,)


def test_rosout_can_be_read_by_the_script(run_script):
    source = """
        from rcl_interfaces.msg import Log
        log.info("early")
        latched = rclpy.qos.QoSProfile(depth=9, durability=1)
        node.create_subscription(Log, "/rosout", lambda m: print(m.name, m.level, m.msg, m.line), latched)
        log.error("late")
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0.1)
    """
    run, _ = run_and_stderr(run_script, source)
    assert run.stdout.splitlines() == ["ns.talker 20 early 10", "ns.talker 40 late 13"]


def test_what_is_on_the_console_alone_is_told_all_the_same(run_script):
    """On Humble a child's messages, and those of a node without a log publisher, reach no subscription."""
    source = """
        from rcl_interfaces.msg import Log
        node.create_subscription(Log, "/rosout", lambda m: print(m.msg), 10)
        silent = rclpy.create_node("silent", enable_rosout=False)
        log.get_child("arm").get_child("hand").info("of a child")
        silent.get_logger().info("of the silent one")
        log.info("heard")
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0.1)
    """
    run, lines = run_and_stderr(run_script, source)
    assert run.stdout.splitlines() == ["heard"]
    assert len(lines) == 3
    told = [cdr for _, cdr in run.published("/rosout")]
    for text, name in ((b"of a child\0", b"ns.talker.arm.hand\0"), (b"of the silent one\0", b"silent\0")):
        assert any(text in cdr and name in cdr for cdr in told)


def test_a_very_long_message_is_shown_whole_and_bounded_on_rosout(run_script):
    run, err = run_and_stderr(run_script, "log.info('长' * 50_000)\n")
    assert err[0].endswith("]: " + "长" * 50_000)
    assert len(run.published("/rosout")[0][1]) < 10_000


def test_two_nodes_of_one_name_share_a_log_publisher_and_are_warned_of(run_script):
    """As logging_rosout.c:159 has it: the first publisher serves both, and goes with either."""
    source = """
        first, second = rclpy.create_node("same"), rclpy.create_node("same")
        print(first.count_publishers("/rosout"))
        other = rclpy.create_node("other")
        heard = []
        from rcl_interfaces.msg import Log
        other.create_subscription(Log, "/rosout", lambda m: heard.append((m.name, m.msg)), 10)
        second.get_logger().info("by the first's publisher")
        first.destroy_node()
        second.get_logger().info("on the console only")
        rclpy.spin_once(other, timeout_sec=0.1)
        rclpy.spin_once(other, timeout_sec=0.1)
        print(heard, other.count_publishers("/rosout"))
    """
    run = run_script("import rclpy\nrclpy.init()\n" + dedent(source))
    assert run.stdout.splitlines() == [
        "2",
        "[('same', \"by the first's publisher\")] 2",
    ]  # one is turtlesim's
    assert run.stderr.count("[rcl.logging_rosout]: Publisher already registered for provided node name.") == 1
    assert "on the console only" in run.stderr


def test_the_episode_is_told_what_a_node_logs_after_its_end(run_script):
    source = """
        import rclpy
        rclpy.init()
        node, late = rclpy.create_node("n"), rclpy.create_node("late")
        node.destroy_node()
        node.get_logger().info("after destruction")
        rclpy.shutdown()
        late.get_logger().info("after shutdown")
    """
    run = run_script(dedent(source))
    texts = (b"destruction", b"shutdown")
    assert [text for _, cdr in run.published("/rosout") for text in texts if text in cdr] == list(texts)


def test_none_is_a_null_pointer_to_c(run_script):
    run, lines = run_and_stderr(run_script, "print(log.info(None))")
    assert run.stdout == "True\n"
    assert lines[0].endswith("(null)")
