import rclpy
import math
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareNode(Node):
    def __init__(self):
        super().__init__('square_node')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.02, self.tick)
        self.state = 'forward'
        self.count = 0
        self.side = 0
        self.done = False

    def tick(self):
        msg = Twist()
        if self.side >= 4:
            self.pub.publish(msg)
            return
        if self.state == 'forward':
            msg.linear.x = 1.0
            self.count += 1
            if self.count >= 100:
                self.count = 0
                self.state = 'turn'
        elif self.state == 'turn':
            msg.angular.z = math.pi / 2
            self.count += 1
            if self.count >= 50:
                self.count = 0
                self.state = 'forward'
                self.side += 1
        self.pub.publish(msg)
        time.sleep(1)


def main():
    rclpy.init()
    rclpy.spin(SquareNode())


if __name__ == '__main__':
    main()
