"""The nodes every ROS 2 course starts with, as pairs in one process: what they show is what ROS 2 shows."""

from collections.abc import Callable
from typing import Any

from tests.shim.course_nodes import HEAD, said

RunScript = Callable[..., Any]


def test_talker_and_listener_share_an_executor(run_script: RunScript) -> None:
    run = run_script(
        HEAD
        + "executor = SingleThreadedExecutor()\nfor node in (Talker(), Listener(), Listener('second')):\n"
        "    executor.add_node(node)\nexecutor.spin()\n",
        horizon_s=2.5,
    )
    assert said(run) == [
        "1.0 listener: heard word 0",
        "1.0 second: heard word 0",
        "2.0 listener: heard word 1",
        "2.0 second: heard word 1",
    ]


def test_a_loop_that_publishes_reaches_a_listener_in_a_thread(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "spin_in_thread(Listener())\nnode = rclpy.create_node('old_school')\n"
        "pub = node.create_publisher(String, 'chatter', 10)\nmsg = String()\n"
        "for msg.data in 'abc':\n    pub.publish(msg)\n    time.sleep(0.5)\n"
    )
    assert said(run) == ["0.0 listener: heard a", "0.5 listener: heard b", "1.0 listener: heard c"]


def test_spin_once_takes_turns_with_other_work(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "talker, listener = Talker(period=0.3), Listener()\n"
        "for i in range(4):\n    rclpy.spin_once(talker)\n    rclpy.spin_once(listener, timeout_sec=0)\n"
    )
    assert [line.split()[0] for line in said(run)] == ["0.3", "0.6", "0.9", "1.2"]


def test_a_raw_subscription_gets_the_serialized_message(run_script: RunScript) -> None:
    source = (
        HEAD + "spin_in_thread(Listener(raw=True))\nnode = Talker()\nnode.talk()\ntime.sleep(0.1)\n"
        "from rclpy.serialization import serialize_message\nprint(serialize_message(String(data='word 0')))\n"
    )
    run = run_script(source)
    wanted = "b'\\x00\\x01\\x00\\x00\\x07\\x00\\x00\\x00word 0\\x00'"
    assert (said(run), run.stdout) == ([f"0.0 listener: heard {wanted}"], wanted + "\n")


def test_best_effort_does_not_reach_a_reliable_listener(run_script: RunScript) -> None:
    spin = "spin_in_thread(Listener({listener}))\nrclpy.spin(Talker(qos={talker}))\n"
    run = run_script(HEAD + spin.format(listener="", talker="qos_profile_sensor_data"), horizon_s=3.5)
    lines = said(run)
    assert len(lines) == 2
    assert all("incompatible QoS" in line and "RELIABILITY" in line for line in lines)
    assert {line.split()[1] for line in lines} == {"talker:", "listener:"}
    run = run_script(HEAD + spin.format(listener="qos=qos_profile_sensor_data", talker="10"), horizon_s=1.5)
    assert said(run) == ["1.0 listener: heard word 0"]


def test_a_late_listener_gets_what_is_kept_for_it(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "kept = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n"
        "node = Talker(qos=kept)\nfor _ in range(3):\n    node.talk()\n"
        "late = Listener(qos=kept)\nfor _ in range(3):\n    rclpy.spin_once(late, timeout_sec=0.1)\n"
    )
    assert said(run) == ["0.0 listener: heard word 1", "0.0 listener: heard word 2"]


def test_a_service_is_called_in_every_way(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "spin_in_thread(Adder())\nnode = rclpy.create_node('client')\n"
        "client = node.create_client(AddTwoInts, 'add')\nassert client.wait_for_service(timeout_sec=1.0)\n"
        "future = client.call_async(AddTwoInts.Request(a=41, b=1))\n"
        "rclpy.spin_until_future_complete(node, future)\nprint(future.result().sum)\n"
        "future = client.call_async(AddTwoInts.Request(a=2, b=3))\n"
        "while not future.done():\n    rclpy.spin_once(node)\nprint(future.result())\n"
        "spin_in_thread(node)\nprint(client.call(AddTwoInts.Request(a=-1, b=-2)).sum)\n"
    )
    assert run.stdout == "42\nexample_interfaces.srv.AddTwoInts_Response(sum=5)\n-3\n"
    assert said(run) == ["0.0 adder: 41 + 1", "0.0 adder: 2 + 3", "0.0 adder: -1 + -2"]


def test_a_callback_awaits_a_service(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "spin_in_thread(Adder())\nnode = rclpy.create_node('client')\n"
        "client = node.create_client(AddTwoInts, 'add', callback_group=ReentrantCallbackGroup())\n"
        "async def ask():\n    timer.cancel()\n    total = 0\n    for i in range(3):\n"
        "        total = (await client.call_async(AddTwoInts.Request(a=total, b=10))).sum\n"
        "    print(total)\n    rclpy.shutdown()\n"
        "timer = node.create_timer(0.5, ask)\nrclpy.spin(node)\n"
    )
    assert run.stdout == "30\n"
    assert said(run) == ["0.5 adder: 0 + 10", "0.5 adder: 10 + 10", "0.5 adder: 20 + 10"]


def test_an_unknown_service_is_waited_for_in_quarter_seconds(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "node = rclpy.create_node('client')\nclient = node.create_client(AddTwoInts, 'nobody')\n"
        "for _ in range(2):\n    print(client.wait_for_service(timeout_sec=0.3), round(time.time() % 10, 2))\n"
    )
    assert run.stdout == "False 0.5\nFalse 1.0\n"


def test_callback_groups_decide_what_overlaps(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "executor = MultiThreadedExecutor(num_threads=4)\nnode = rclpy.create_node('groups')\n"
        "one, free = MutuallyExclusiveCallbackGroup(), ReentrantCallbackGroup()\n"
        "def work(name):\n    node.get_logger().info(name)\n    time.sleep(0.5)\n"
        "for name, group in (('a', one), ('b', one), ('c', free), ('d', free)):\n"
        "    node.create_timer(2.0, lambda name=name: work(name), callback_group=group)\n"
        "executor.add_node(node)\nexecutor.spin()\n",
        horizon_s=3.0,
    )
    assert sorted(said(run)) == ["2.0 groups: a", "2.0 groups: c", "2.0 groups: d", "2.5 groups: b"]


def test_an_executor_of_ones_own_decides_what_runs_where(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "from concurrent.futures import ThreadPoolExecutor\n"
        "class Priority(Executor):\n    def __init__(self):\n        super().__init__()\n"
        "        self.urgent = set()\n"
        "        self.quick, self.slow = ThreadPoolExecutor(4), ThreadPoolExecutor(1)\n"
        "    def spin_once(self, timeout_sec=None):\n        try:\n"
        "            handler, group, node = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)\n"
        "        except StopIteration:\n            return\n"
        "        (self.quick if node in self.urgent else self.slow).submit(handler)\n"
        "class Busy(Talker):\n    def talk(self):\n        super().talk()\n        time.sleep(0.8)\n"
        "executor = Priority()\nfor node in (Busy(), Busy('second'), Listener()):\n    executor.add_node(node)\n"
        "executor.urgent.add(node)\nexecutor.spin()\n",
        horizon_s=2.9,
    )
    heard = [line.split()[0] for line in said(run)]
    assert heard == ["1.0", "1.8", "2.6"]  # one slow thread: the talkers take turns


def test_a_callback_group_of_ones_own_limits_the_rate(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "class Tokens(CallbackGroup):\n"
        "    def __init__(self, node):\n        super().__init__()\n        self.left = 3\n"
        "        self.timer = node.create_timer(1.0, self.refill)\n"
        "    def refill(self):\n        self.left += 1\n"
        "    def can_execute(self, entity):\n        return self.left > 0\n"
        "    def beginning_execution(self, entity):\n"
        "        if self.left <= 0:\n            return False\n        self.left -= 1\n        return True\n"
        "    def ending_execution(self, entity):\n        pass\n"
        "class Limited(Talker):\n    def __init__(self):\n        super().__init__('limited', 0.1)\n"
        "        list(self.timers)[0].callback_group = Tokens(self)\n"
        "    def talk(self):\n        self.get_logger().info(f'{self.count}')\n        super().talk()\n"
        "rclpy.spin(Limited())\n",
        horizon_s=2.95,
    )
    times = [line.split()[0] for line in said(run)]
    assert times[:3] == ["0.1", "0.2", "0.3"]
    assert len(times) == 5
    assert [time[0] for time in times[3:]] == ["1", "2"]


def test_a_guard_condition_wakes_spin_once(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "node = rclpy.create_node('guarded')\nlog = node.get_logger()\n"
        "guard = node.create_guard_condition(lambda: log.info('guard'))\n"
        "timer = node.create_timer(2.0, guard.trigger)\n"
        "for _ in range(2):\n    rclpy.spin_once(node)\n    log.info('next')\n"
    )
    assert said(run) == ["2.0 guarded: next", "2.0 guarded: guard", "2.0 guarded: next"]


def test_parameters_are_read_and_set_over_services(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters\n"
        "from rclpy.parameter import Parameter\n"
        "owner = rclpy.create_node('owner')\nowner.declare_parameter('speed', 1.5)\nspin_in_thread(owner)\n"
        "node = rclpy.create_node('remote')\n"
        "def ask(kind, name, **fields):\n    client = node.create_client(kind, name)\n"
        "    future = client.call_async(kind.Request(**fields))\n"
        "    rclpy.spin_until_future_complete(node, future)\n    return future.result()\n"
        "print('speed' in ask(ListParameters, '/owner/list_parameters').result.names)\n"
        "print(ask(GetParameters, '/owner/get_parameters', names=['speed']).values[0].double_value)\n"
        "for value in (2.5, 'fast'):\n"
        "    new = [Parameter('speed', value=value).to_parameter_msg()]\n"
        "    print(ask(SetParameters, '/owner/set_parameters', parameters=new).results[0].successful)\n"
        "print(owner.get_parameter('speed').value)\n"
    )
    assert run.stdout == "True\n1.5\nTrue\nFalse\n2.5\n"


def test_ctrl_c_ends_both_ends_of_a_pair(run_script: RunScript) -> None:
    run = run_script(
        HEAD + "from rclpy.executors import ExternalShutdownException\n"
        "def listen():\n    try:\n        rclpy.spin(Listener(), executor=SingleThreadedExecutor())\n"
        "    except ExternalShutdownException:\n        print('listener ends')\n"
        "thread = threading.Thread(target=listen)\nthread.start()\n"
        "try:\n    rclpy.spin(Talker())\nexcept KeyboardInterrupt:\n    print('talker ends')\n"
        "thread.join()\nprint(rclpy.ok())\n",
        horizon_s=1.5,
    )
    assert said(run) == ["1.0 listener: heard word 0"]
    assert sorted(run.stdout.split("\n")) == ["", "False", "listener ends", "talker ends"]
