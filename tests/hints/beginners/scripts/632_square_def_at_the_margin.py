#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time
import math

class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 1.0
        self.TURN_SPEED = 1.0
        self.SIDE_LENGTH = 2.0
        self.MOVE_TIME = self.SIDE_LENGTH / self.SPEED
        self.TURN_TIME = 1.5708 / self.TURN_SPEED

    def move_straight(self, duration):
        msg = Twist()
        msg.linear.x = float(self.SPEED)
        start_time = self.get_clock().now()
        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

    def turn(self, duration):
        msg = Twist()
        msg.angular.z = float(self.TURN_SPEED)
        start_time = self.get_clock().now()
        while (self.get_clock().now() - start_time).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

def stop(self):
    msg = Twist()
    self.cmd_vel_pub.publish(msg)
    time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.move_straight(self.MOVE_TIME)
            self.turn(self.TURN_TIME)

def main(args=None):
    rclpy.init(args=args)
    node = SquareMover()
    time.sleep(1)
    node.move_square()
    node.destroy_node()
    rclpy.shutdown()

if __name__ == '__main__':
    main()
