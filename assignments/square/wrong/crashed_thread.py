"""在后台线程里驾驶，线程里却用了没有定义的变量。"""

import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        threading.Thread(target=self.run, daemon=True).start()

    def drive(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.01)
        self.publisher.publish(Twist())

    def run(self):
        for _ in range(4):
            self.drive(1.0, 0.0, 2.0)
            self.drive(0.0, 1.0, turn_time)


def main():
    rclpy.init()
    rclpy.spin(Square())


if __name__ == '__main__':
    main()
