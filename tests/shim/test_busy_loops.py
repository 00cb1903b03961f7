"""Loops that never block: they let others run, and time passes for those who wait."""

from collections.abc import Callable
from typing import Any

import pytest

RunScript = Callable[..., Any]
CLOCK = "import threading, time\ndef now(): return round(time.time() - 1.7e9, 2)\n"
SET_LATER = (
    "done = False\ndef later():\n    global done\n"
    "    time.sleep(2)\n    done = True\n    print('set', now())\n"
)


@pytest.mark.parametrize(
    "loop",
    [
        "while not done: pass",
        "while True:\n    if done: break",
        "while not done:\n    continue",
        "n = 0\nwhile not done:\n    n += 1",
        "while not done: time.time()",
        "while not done: time.sleep(0)",
        "while t.is_alive(): pass",
        "import itertools\nfor _ in itertools.count():\n    if done: break",
        "lock = threading.Lock(); lock.acquire()\nwhile not done: lock.acquire(False)",
        "def spin():\n    while not done: pass\nspin()",
    ],
)
def test_a_loop_on_a_flag_ends_when_another_thread_sets_it(run_bare: RunScript, loop: str) -> None:
    run = run_bare(
        CLOCK + SET_LATER + f"t = threading.Thread(target=later)\nt.start()\n{loop}\nprint('seen', now())\n"
    )
    assert run.stdout.splitlines()[0] == "set 2.0"
    assert run.stdout.splitlines()[1] in ("seen 2.0", "seen 2.01")


def test_two_spinning_threads_take_turns(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "turn = 0\ndef work(me):\n    global turn\n    for _ in range(3):\n"
        "        while turn % 2 != me: pass\n        print(me, end=' ')\n        turn += 1\n"
        "threading.Thread(target=work, args=(1,)).start()\nwork(0)\n"
    )
    assert run.stdout == "0 1 0 1 0 1 "


def test_a_busy_thread_does_not_keep_another_from_its_deadlines(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "ticks = []\ndef tick():\n    for _ in range(5):\n        time.sleep(0.25)\n"
        "        ticks.append(round(time.time() - 1.7e9, 4))\n"
        "threading.Thread(target=tick).start()\nwhile len(ticks) < 5: pass\nprint(ticks)\n"
    )
    ticks = eval(run.stdout)
    assert [round(t, 2) for t in ticks] == [0.25, 0.5, 0.75, 1.0, 1.25]


def test_a_busy_clock_loop_beside_a_publisher_thread(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + "count = 0\ndef work():\n    global count\n    while not done:\n        time.sleep(0.1)\n"
        "        count += 1\ndone = False\nt = threading.Thread(target=work); t.start()\n"
        "start = time.monotonic()\nwhile time.monotonic() - start < 3: pass\ndone = True\nt.join()\nprint(count)\n"
    )
    assert run.stdout in ("30\n", "31\n")


def test_a_loop_that_computes_takes_no_time_when_alone(run_bare: RunScript) -> None:
    run = run_bare("n = 0\nwhile n < 200_000: n += 1\nprint(n)\n")
    assert (run.stdout, run.exit["t_ns"]) == ("200000\n", 0)


def test_a_loop_that_blocks_costs_no_extra_time_beside_threads(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK
        + "threading.Thread(target=threading.Event().wait, daemon=True).start()\nn = 0\nstart = time.time_ns()\n"
        "while n < 3000:\n    n += 1\n    time.sleep(0.01)\nprint(time.time_ns() - start)\n"
    )
    assert run.stdout == "30000001000\n"


@pytest.mark.parametrize(
    "loop",
    [
        "while rclpy.ok(): rclpy.spin_once(node, timeout_sec=0)",
        "while rclpy.ok(): rclpy.spin_once(node, timeout_sec=0.001)",
        "while rclpy.ok(): node.get_clock().now(); publisher.publish(Twist())",
        "node.create_timer(0.001, lambda: publisher.publish(Twist()))\nrclpy.spin(node)",
        "import threading, time\nthreading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n"
        "while rclpy.ok(): time.sleep(0.0007)",
    ],
)
def test_whoever_listens_to_the_pose_asks_the_world_once_a_pose(run_script: RunScript, loop: str) -> None:
    script = (
        "import rclpy\nfrom geometry_msgs.msg import Twist\nfrom turtlesim.msg import Pose\n"
        "rclpy.init()\nnode = rclpy.create_node('listener')\n"
        "publisher = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)\n"
        "node.create_subscription(Pose, '/turtle1/pose', lambda pose: None, 10)\n"
    )
    poses = [(t_ns, "/turtle1/pose", b"\0\1\0\0" + bytes(20)) for t_ns in range(0, 2_000_000_000, 16_000_000)]
    run = run_script(script + loop, horizon_s=2.0, feed=poses)
    asked = len(run.of("ADVANCE"))
    assert 100 < asked <= 2 * 62.5 + 2  # and once after each of the two announcements


def test_a_loop_that_main_has_left_alone_ends_by_its_steps(run_bare: RunScript) -> None:
    """As in the main thread: no time passes beside it, so it is not the horizon that ends it."""
    source = "import threading\ndef work():\n    while True: pass\nthreading.Thread(target=work).start()\n"
    end = run_bare(source, steps=1_000).exit
    assert (end["reason"], end["after_interrupt"]) == (5, 0)
    assert end["t_ns"] < 0.01 * 10**9


def test_time_passes_for_a_loop_that_a_sleeper_may_end_after_main(run_bare: RunScript) -> None:
    run = run_bare(
        CLOCK + SET_LATER + "def work():\n    while not done: pass\n    print('seen', now())\n"
        "for target in (work, later): threading.Thread(target=target).start()\n"
    )
    assert run.stdout.splitlines()[0] == "set 2.0"


LARGE = {
    "numbers": "from std_msgs.msg import UInt8MultiArray as Kind\nfield, values = 'data', [1] * 512_000\n",
    "messages": (
        "from nav_msgs.msg import Path as Kind\nfrom geometry_msgs.msg import PoseStamped\n"
        "field, values = 'poses', [PoseStamped() for _ in range(4_000)]\n"
    ),
}


@pytest.mark.parametrize("kind", LARGE)
def test_large_messages_count_as_steps(kind: str, run_script: RunScript) -> None:
    """A thousand each, so that a script which sends them for ever ends at the same place on every machine."""
    script = (
        "import rclpy\n" + LARGE[kind] + "rclpy.init()\nnode = rclpy.create_node('n')\n"
        "publisher = node.create_publisher(Kind, 'large', 10)\n"
        "def tick():\n    message = Kind()\n    setattr(message, field, values)\n    publisher.publish(message)\n"
        "node.create_subscription(Kind, 'large', lambda m: None, 10)\n"
        "node.create_timer(0.1, tick)\nrclpy.spin(node)\n"
    )
    ends = [run_script(script, steps=steps, horizon_s=10.0).exit["t_ns"] for steps in (5_000, 5_000, 10_000)]
    assert ends[0] == ends[1]
    assert 0.15 * 10**9 < ends[0] < 0.7 * 10**9
    assert 0.35 * 10**9 < ends[2] < 1.2 * 10**9
