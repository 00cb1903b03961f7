import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class A(Node):
    def __init__(self):
        super().__init__('a')
        p = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        msg = Twist()
        msg.linear.x = -0.5
        end_time = time.time() + 3
        while time.time() < end_time:
            p.publish(msg)
            time.sleep(0.1)
        p.publish(Twist())


def main(args=None):
    rclpy.init(args=args)
    A()
    rclpy.shutdown()


main()
