from enum import Enum
import math

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class State(Enum):
    FORWARD = 1
    TURN = 2
    DONE = 3


class TriangleNode(Node):
    def __init__(self):
        super().__init__('triangle_node')
        self.pub = self.create_publisher(Twist, 'turtle1/cmd_vel', 10)
        self.state = State.FORWARD
        self.sides = 0
        self.state_start = self.get_clock().now()
        self.create_timer(0.05, self.update)

    def change(self, state):
        self.get_logger().info(f'{self.state.name} -> {state.name}')
        self.state = state
        self.state_start = self.get_clock().now()

    def update(self):
        elapsed = (self.get_clock().now() - self.state_start).nanoseconds / 1e9
        if self.state == State.FORWARD and elapsed >= 2.0:
            self.change(State.TURN)
        elif self.state == State.TURN and elapsed >= 2.0:
            self.sides += 1
            self.change(State.FORWARD if self.sides < 3 else State.DONE)
        cmd = Twist()
        if self.state == State.FORWARD:
            cmd.linear.x = 1.0
        elif self.state == State.TURN:
            cmd.angular.z = math.radians(120.0) / 2.0
        self.pub.publish(cmd)
        if self.state == State.DONE:
            raise SystemExit


def main():
    rclpy.init()
    node = TriangleNode()
    try:
        rclpy.spin(node)
    except SystemExit:
        node.get_logger().info('bye')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
