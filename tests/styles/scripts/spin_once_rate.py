import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Once(Node):
    def __init__(self):
        super().__init__('once')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.rate = self.create_rate(10)  # its hidden timer is what wakes spin_once


def main(args=None):
    rclpy.init(args=args)
    node = Once()
    t = Twist()
    i = 0
    while rclpy.ok():
        t.linear.x = 1.0 if i < 20 else 0.0
        node.pub.publish(t)
        if i == 25:
            break
        i += 1
        rclpy.spin_once(node)
    rclpy.shutdown()


main()
