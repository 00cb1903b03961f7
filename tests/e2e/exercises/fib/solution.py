import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.node import Node


class FibServer(Node):
    def __init__(self):
        super().__init__("fib_server")
        self.s = ActionServer(self, Fibonacci, "fibonacci", self.execute)

    def execute(self, goal):
        fb = Fibonacci.Feedback()
        fb.sequence = [0, 1]
        for i in range(1, goal.request.order):
            fb.sequence.append(fb.sequence[i] + fb.sequence[i - 1])
            goal.publish_feedback(fb)
            time.sleep(0.2)
        goal.succeed()
        r = Fibonacci.Result()
        r.sequence = fb.sequence
        return r


def main():
    rclpy.init()
    rclpy.spin(FibServer())


if __name__ == "__main__":
    main()
