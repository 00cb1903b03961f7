import math
import time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Tri(Node):
    def __init__(self):
        super().__init__('tri')
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
        for i in range(4):
            self.drive(1.0, 0.0, 2.0)
            self.drive(0.0, 1.0, math.radians(120))


def main():
    rclpy.init()
    node = Tri()
    time.sleep(0.5)
    node.run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
