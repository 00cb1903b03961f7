"""The nodes every ROS 2 course starts with, in one process, and what they log."""

import re
from typing import Any

HEAD = """\
import sys, threading, time
import rclpy
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_sensor_data, DurabilityPolicy
from std_msgs.msg import String
from example_interfaces.srv import AddTwoInts
from example_interfaces.action import Fibonacci

class Talker(Node):
    def __init__(self, name='talker', period=1.0, qos=10, group=None):
        super().__init__(name)
        self.count = 0
        self.pub = self.create_publisher(String, 'chatter', qos)
        self.create_timer(period, self.talk, callback_group=group)
    def talk(self):
        self.pub.publish(String(data=f'word {self.count}'))
        self.count += 1

class Listener(Node):
    def __init__(self, name='listener', qos=10, raw=False):
        super().__init__(name)
        self.create_subscription(String, 'chatter', self.hear, qos, raw=raw)
    def hear(self, msg):
        self.get_logger().info(f'heard {msg if isinstance(msg, bytes) else msg.data}')

class Adder(Node):
    def __init__(self):
        super().__init__('adder')
        self.create_service(AddTwoInts, 'add', self.add)
    def add(self, request, response):
        response.sum = request.a + request.b
        self.get_logger().info(f'{request.a} + {request.b}')
        return response

def spin_in_thread(node, executor=None):
    executor = executor or SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()

rclpy.init()
"""

ACTIONS = """
class Server(Node):
    def __init__(self, **callbacks):
        super().__init__('server')
        self.server = ActionServer(self, Fibonacci, 'fibonacci', self.execute,
                                   callback_group=ReentrantCallbackGroup(), **callbacks)
    def execute(self, goal):
        sequence = [0, 1]
        for i in range(1, goal.request.order):
            if not goal.is_active:
                return Fibonacci.Result()
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sequence[i] + sequence[i - 1])
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
            time.sleep(1)
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)

class Client(Node):
    def __init__(self, name='client'):
        super().__init__(name)
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
    def send(self, order):
        assert self.client.wait_for_server(timeout_sec=1.0)
        future = self.client.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=self.on_feedback)
        self.wait(future)
        self.get_logger().info('accepted' if future.result().accepted else 'rejected')
        return future.result()
    def result(self, handle):
        future = handle.get_result_async()
        self.wait(future)
        answer = future.result()
        self.get_logger().info(f'status {answer.status} {list(answer.result.sequence)}')
    def wait(self, future):
        rclpy.spin_until_future_complete(self, future)
    def on_feedback(self, feedback):
        self.get_logger().info(f'feedback {list(feedback.feedback.sequence)}')
"""

_LOG = re.compile(r"^\[(?:INFO|WARN)\] \[17000000(\d\d\.\d)\d*\] \[(\w+)\]: (.*)$", re.MULTILINE)


def said(run: Any) -> list[str]:
    """Return the log as ``seconds node: message``, seconds to a tenth."""
    return [f"{float(t):.1f} {node}: {text}" for t, node, text in _LOG.findall(run.stderr)]
