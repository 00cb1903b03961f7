import math

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareNode(Node):
    """定时器 + 计数器走正方形"""

    def __init__(self):
        super().__init__('square_node')
        self.publisher_ = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.timer_callback)
        self.count = 0

    def timer_callback(self):
        msg = Twist()
        if self.count >= 120:
            self.publisher_.publish(msg)
            self.timer.cancel()
            self.get_logger().info('完成')
            return
        if self.count % 30 < 20:
            msg.linear.x = 1.0
        else:
            msg.angular.z = math.pi / 2
        self.publisher_.publish(msg)
        self.count += 1


def main(args=None):
    rclpy.init(args=args)
    node = SquareNode()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
