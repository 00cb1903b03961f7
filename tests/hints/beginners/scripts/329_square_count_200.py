import rclpy
import time
import math
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Count(Node):
    def __init__(self):
        super().__init__('count')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def times(self, msg, n):
        for i in range(n):
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.2)


def main():
    rclpy.init()
    c = Count()
    time.sleep(1)
    go = Twist()
    go.linear.x = 1.0
    left = Twist()
    left.angular.z = math.pi / 2
    for i in range(4):
        c.times(go, 200)
        c.times(left, 100)
    c.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
