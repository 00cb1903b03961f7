import math
import time

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.speed = 1.0
        self.turn_speed = 1.0
        self.side = 2.0

    def run_for(self, v, w, seconds):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        t0 = time.time()
        while time.time() - t0 < seconds:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.2)

    def forward(self):
        self.run_for(self.speed, 0.0, self.side / self.speed)

    def left(self):
        self.run_for(self.turn_speed, 0.0, math.pi / 2 / self.turn_speed)

    def square(self):
        for i in range(4):
            self.get_logger().info('side %d' % (i + 1))
            self.forward()
            self.left()


def main(args=None):
    rclpy.init(args=args)
    node = Square()
    time.sleep(1)
    node.square()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
