import math
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareParam(Node):
    def __init__(self):
        super().__init__('square_param')
        self.declare_parameter('side', 2.0)
        self.side = self.get_parameter('side').value
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def act(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.pub.publish(m)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)


def main():
    rclpy.init(args=[])
    node = SquareParam()
    time.sleep(1)
    for _ in range(4):
        node.act(1.0, 0.0, node.side)
        node.act(0.0, 1.0, math.pi / 2)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
