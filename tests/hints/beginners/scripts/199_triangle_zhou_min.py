#!/usr/bin/env python3
"""
任务1：走三角形      周敏  2024012
"""
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class TriangleMover(Node):
    def __init__(self):
        super().__init__('triangle_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 1.0
        self.TURN_SPEED = 1.0
        self.SIDE_LENGTH = 2.0
        self.MOVE_TIME = self.SIDE_LENGTH / self.SPEED
        # 外角 = 120° = 2π/3 ≈ 2.094 rad
        self.TURN_TIME_TRIANGLE = 2.094 / self.TURN_SPEED

    def move_straight(self, duration):
        msg = Twist()
        msg.linear.x = self.SPEED
        start_time = self.get_clock().now()
        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

    def turn(self, duration):
        msg = Twist()
        msg.angular.z = self.TURN_SPEED
        start_time = self.get_clock().now()
        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

    def stop(self):
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_triangle(self):
        for i in range(3):
            self.move_straight(self.MOVE_TIME)
            self.turn(self.TURN_TIME_TRIANGLE)
        self.get_logger().info('🎉 三角形走完!')


def main(args=None):
    rclpy.init(args=args)
    node = TriangleMover()
    time.sleep(1)
    node.move_triangle()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
