"""message_filters: exact and approximate synchronisation, caches, headerless messages."""

from collections.abc import Callable
from typing import Any

RunScript = Callable[..., Any]
HEAD = """
import rclpy, message_filters
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from turtlesim.msg import Pose

rclpy.init()
node = Node('n')

def stamped(ms):
    msg = PointStamped()
    msg.header.stamp = Time(sec=ms // 1000, nanosec=ms % 1000 * 10**6)
    msg.point.x = float(ms)
    return msg

def send(**times):
    for name, ms in times.items():
        pubs[name].publish(stamped(ms))
        for _ in range(3):
            rclpy.spin_once(node, timeout_sec=0.01)

pubs = {name: node.create_publisher(PointStamped, name, 10) for name in 'ab'}
subs = [message_filters.Subscriber(node, PointStamped, name) for name in 'ab']
"""


def test_sets_of_the_same_stamp(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "both = message_filters.TimeSynchronizer(subs, 2)\n"
        "both.registerCallback(lambda a, b, *more: print(a.point.x, b.point.x, more), 'x')\n"
        "send(a=1); send(a=2); send(b=2); send(b=1); send(a=3); send(a=4); send(a=5); send(b=3); send(b=5)\n"
        "print(subs[0].getTopic(), subs[0].topic_name, len(both.queues[0]))\n"
    )
    # 3 had to make room in the queue of two before its counterpart came.
    assert run.stdout.splitlines() == ["2.0 2.0 ('x',)", "1.0 1.0 ('x',)", "5.0 5.0 ('x',)", "a /a 1"], (
        run.stderr
    )


def test_sets_of_nearly_the_same_stamp(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "both = message_filters.ApproximateTimeSynchronizer(subs, 5, 0.1)\n"
        "both.registerCallback(lambda a, b: print(a.point.x, b.point.x))\n"
        "for times in ({'a': 1000}, {'a': 1050}, {'b': 1060}, {'b': 1200}, {'a': 1300}, {'b': 1090}):\n"
        "    send(**times)\n"
        "poses = message_filters.Subscriber(node, Pose, 'p')\n"
        "strict = message_filters.ApproximateTimeSynchronizer([poses], 5, 0.1)\n"
        "node.create_publisher(Pose, 'p', 1).publish(Pose())\nrclpy.spin_once(node)\n"
        "free = message_filters.ApproximateTimeSynchronizer([strict], 5, 0.1, allow_headerless=True)\n"
        "free.registerCallback(lambda p: print('headerless', p.x))\n"
        "free.add(Pose(x=2.0), free.queues[0], 0)\n"
    )
    assert run.stdout.splitlines() == ["1050.0 1060.0", "1000.0 1090.0", "headerless 2.0"], run.stderr
    assert (
        "[message_filters_approx]: can not use message filters for messages without timestamp" in run.stderr
    )


def test_a_cache_answers_by_time(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "from rclpy.time import Time as T\n"
        "cache = message_filters.Cache(subs[0], 3)\n"
        "print(cache.getLast(), cache.getOldestTime())\n"
        "for ms in (1000, 2000, 3000, 4000): send(a=ms)\n"
        "at = lambda s: T(seconds=s, clock_type=cache.getOldestTime().clock_type)\n"
        "print(cache.getOldestTime().nanoseconds, cache.getLastestTime().nanoseconds, cache.getLast().point.x)\n"
        "print([m.point.x for m in cache.getInterval(at(2), at(3.0))], cache.getElemAfterTime(at(2.5)).point.x)\n"
        "print(cache.getElemBeforeTime(at(2.5)).point.x, cache.getElemBeforeTime(at(1)))\n"
    )
    assert run.stdout.splitlines() == [
        *("None None", "2000000000 4000000000 4000.0", "[2000.0, 3000.0] 3000.0", "2000.0 None"),
    ], run.stderr
