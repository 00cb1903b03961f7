import math
import time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

SIDE = 2.0
SPEED = 1.0


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + seconds
        while time.time() < end:
            self.publisher.publish(msg)
            time.sleep(0.01)
        self.publisher.publish(Twist())
        time.sleep(0.1)

    def run(self):
        for _ in range(4):
            self.drive(SPEED, 0.0, SIDE / SPEED)
            self.drive(0.0, 1.0, math.pi / 3)


def main():
    rclpy.init()
    node = Square()
    time.sleep(0.5)
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
