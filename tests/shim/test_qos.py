"""QoS profiles and policies."""

from textwrap import dedent

PREFIX = """
import warnings
from rclpy.qos import *
from rclpy.duration import Duration
def attempt(call):
    try:
        print(call())
    except Exception as error:
        print(type(error).__name__, error)
"""


def run_lines(run_script, source):
    run = run_script(PREFIX + dedent(source))
    assert run.exit["reason"] == 0, run.stderr
    return run.stdout.splitlines()


def test_profiles(run_script):
    source = """
        print(QoSProfile(depth=3))
        print(QoSProfile(depth=3) == QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=3))
        attempt(QoSProfile)
        attempt(lambda: QoSProfile(history=1))
        attempt(lambda: QoSProfile(depth="3"))
        attempt(lambda: QoSProfile(dept=3))
    """
    assert run_lines(run_script, source) == [
        "QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=3, reliability=ReliabilityPolicy.RELIABLE, "
        "durability=DurabilityPolicy.VOLATILE, lifespan=0 nanoseconds, deadline=0 nanoseconds, "
        "liveliness=LivelinessPolicy.SYSTEM_DEFAULT, liveliness_lease_duration=0 nanoseconds, "
        "avoid_ros_namespace_conventions=False)",
        "True",
        "InvalidQoSProfileException ('Invalid QoSProfile', 'History and/or depth settings are required.')",
        "InvalidQoSProfileException ('Invalid QoSProfile', 'History set to KEEP_LAST without a depth setting.')",
        "AssertionError ",
        "AssertionError Invalid arguments passed to constructor: dict_keys(['dept'])",
    ]


def test_presets_and_names(run_script):
    source = """
        sensor = QoSPresetProfiles.get_from_short_key("sensor_data")
        print(sensor is qos_profile_sensor_data, sensor.depth, sensor.reliability.name, f"{sensor.reliability}")
        print(QoSReliabilityPolicy is ReliabilityPolicy, DurabilityPolicy.short_keys())
        print(ReliabilityPolicy.BEST_EFFORT.short_key, ReliabilityPolicy.get_from_short_key("reliable"))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            print(ReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_RELIABLE.name, caught[0].message)
    """
    assert run_lines(run_script, source) == [
        "True 5 BEST_EFFORT 2",
        "True ['system_default', 'transient_local', 'volatile', 'unknown']",
        "best_effort 1",
        "RELIABLE ReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_RELIABLE is deprecated. "
        "Use ReliabilityPolicy.RELIABLE instead.",
    ]


def test_compatibility(run_script):
    source = """
        best, latched = QoSProfile(depth=1, reliability=2), QoSProfile(depth=1, durability=1)
        plain, timed = QoSProfile(depth=1), QoSProfile(depth=1, deadline=Duration(seconds=1))
        for offer, request in ((plain, plain), (best, plain), (plain, best), (plain, latched), (plain, timed)):
            verdict, reason = qos_check_compatible(offer, request)
            print(verdict.name, reason)
    """
    assert run_lines(run_script, source) == [
        "WARNING WARNING: Publisher liveliness is system_default and subscription liveliness is system_default;",
        "ERROR ERROR: Best effort publisher and reliable subscription;",
        "WARNING WARNING: Publisher liveliness is system_default and subscription liveliness is system_default;",
        "ERROR ERROR: Volatile publisher and transient local subscription;",
        "ERROR ERROR: Subscription has a deadline, but publisher does not;",
    ]


def test_what_others_learn_of_an_endpoint_is_what_rmw_fastrtps_fills_in(run_script):
    """qos.cpp:38 leaves DDS' defaults where a profile says nothing; qos.hpp:140 tells no history and no depth."""
    source = """
        import rclpy
        from rclpy.duration import Duration
        from rclpy.qos import QoSProfile, qos_profile_system_default
        from std_msgs.msg import String
        rclpy.init()
        node = rclpy.create_node("n")
        node.create_publisher(String, "plain", 7)
        node.create_publisher(String, "system", qos_profile_system_default)
        node.create_subscription(String, "system", print, qos_profile_system_default)
        node.create_publisher(String, "asked", QoSProfile(depth=1, deadline=Duration(seconds=2), reliability=2))
        def show(info):
            p = info.qos_profile
            print(p.history.name, p.depth, p.reliability.name, p.durability.name, p.lifespan, p.deadline,
                  p.liveliness.name, p.liveliness_lease_duration)
        for info in (
            *node.get_publishers_info_by_topic("plain"), *node.get_publishers_info_by_topic("system"),
            *node.get_subscriptions_info_by_topic("system"), *node.get_publishers_info_by_topic("asked"),
        ):
            show(info)
    """
    run = run_script(dedent(source))
    assert run.stdout.splitlines() == [
        "UNKNOWN 0 RELIABLE VOLATILE Infinite Infinite AUTOMATIC Infinite",
        "UNKNOWN 0 RELIABLE TRANSIENT_LOCAL Infinite Infinite AUTOMATIC Infinite",
        "UNKNOWN 0 BEST_EFFORT VOLATILE Infinite Infinite AUTOMATIC Infinite",
        "UNKNOWN 0 BEST_EFFORT VOLATILE Infinite 2000000000 nanoseconds AUTOMATIC Infinite",
    ], run.stderr
