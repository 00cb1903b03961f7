import math
import time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

SIDE = 1.5
SPEED = 1.0


class Triangle(Node):
    def __init__(self):
        super().__init__('triangle')
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
        i = 0
        while i <= 3:
            self.drive(SPEED, 0.0, SIDE / SPEED)
            self.drive(0.0, 1.0, math.pi / 3)
            i += 1


def main():
    rclpy.init()
    node = Triangle()
    time.sleep(0.5)
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
