#!/usr/bin/env python3
# 钱多  任务2 五边形
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class PentagonMover(Node):

    def __init__(self):
        super().__init__('pentagon_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 1.0
        self.TURN_SPEED = 1.0
        self.SIDE_LENGTH = 1.5
        self.MOVE_TIME = self.SIDE_LENGTH / self.SPEED
        self.TURN_TIME_PENTAGON = 1.257 / self.TURN_SPEED

    def _cmd(self, v, w, duration):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        start = self.get_clock().now()
        while (self.get_clock().now() - start).nanoseconds < duration * 1e9:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_pentagon(self):
        for i in range(5):
            self.get_logger().info(f'第{i + 1}/5条边')
            self._cmd(self.SPEED, 0.0, self.MOVE_TIME)
            self._cmd(0.0, self.TURN_SPEED, self.TURN_TIME_PENTAGON)


def main(args=None):
    rclpy.init(args=args)
    node = PentagonMover()
    time.sleep(1)
    node.move_pentagon()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
