"""Drives straight ahead for a while, then stops."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

from my_turtle.motion import forward, stop


class Drive(Node):

    def __init__(self):
        super().__init__('drive')
        self.speed = self.declare_parameter('speed', 1.0).value
        self.duration = self.declare_parameter('duration', 2.0).value
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.left = round(self.duration / 0.1)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        if self.left > 0:
            self.left -= 1
            self.pub.publish(forward(self.speed))
        else:
            self.pub.publish(stop())
            self.get_logger().info('arrived')
            self.timer.cancel()


def main(args=None):
    rclpy.init(args=args)
    node = Drive()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
