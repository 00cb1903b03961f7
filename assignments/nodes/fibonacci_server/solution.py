"""Fibonacci action server."""

import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class FibonacciServer(Node):
    def __init__(self):
        super().__init__('fibonacci_server')
        self.server = ActionServer(
            self, Fibonacci, 'fibonacci', self.execute, goal_callback=self.on_goal,
            cancel_callback=self.on_cancel, callback_group=ReentrantCallbackGroup())

    def on_goal(self, goal):
        return GoalResponse.ACCEPT if goal.order >= 1 else GoalResponse.REJECT

    def on_cancel(self, handle):
        return CancelResponse.ACCEPT

    def execute(self, handle):
        feedback = Fibonacci.Feedback()
        feedback.sequence = [0, 1]
        result = Fibonacci.Result()
        for i in range(1, handle.request.order):
            if handle.is_cancel_requested:
                handle.canceled()
                result.sequence = feedback.sequence
                return result
            feedback.sequence.append(feedback.sequence[i] + feedback.sequence[i - 1])
            handle.publish_feedback(feedback)
            time.sleep(0.5)
        handle.succeed()
        result.sequence = feedback.sequence
        return result


def main():
    rclpy.init()
    node = FibonacciServer()
    try:
        rclpy.spin(node, executor=MultiThreadedExecutor())
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
