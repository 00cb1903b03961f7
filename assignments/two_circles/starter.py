"""两个圆：在 run() 里补全。"""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__('two_circles')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, seconds):
        """以线速度 v、角速度 w 行驶 seconds 秒，然后停一下。"""
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.02)
        self.publisher.publish(Twist())
        time.sleep(0.1)

    def run(self):
        # TODO：走一圈，半径 0.8 m；再走一圈，半径 1.6 m
        pass


def main():
    rclpy.init()
    node = Driver()
    time.sleep(0.5)  # 等发布者和小乌龟连上
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
